// Typed 32-bit handles of mesh elements.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace vkmesh {

/// The index that stands for "none": the twin of a boundary half-edge, the leading half-edge of an isolated
/// vertex.
inline constexpr std::uint32_t kInvalid = 0xffffffffu;

/// An index that knows what it counts. 4 bytes; holds no pointer to a mesh.
template <class Tag>
struct Handle {
  std::uint32_t index = kInvalid;

  constexpr Handle() = default;
  constexpr explicit Handle(std::uint32_t i) : index(i) {}

  [[nodiscard]] constexpr bool valid() const { return index != kInvalid; }
  friend constexpr auto operator<=>(Handle, Handle) = default;
};

using VertexId = Handle<struct VertexTag>;
using HalfEdgeId = Handle<struct HalfEdgeTag>;
using FaceId = Handle<struct FaceTag>;

}  // namespace vkmesh

template <class Tag>
struct std::hash<vkmesh::Handle<Tag>> {
  std::size_t operator()(vkmesh::Handle<Tag> h) const noexcept { return std::hash<std::uint32_t>{}(h.index); }
};
