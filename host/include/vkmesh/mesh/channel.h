// Named attributes of points, corners or faces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <vkmesh/base/api.h>

namespace vkmesh {

/// The values of a channel, in the scalar type the file gave them.
using ChannelValues =
    std::variant<std::vector<float>, std::vector<double>, std::vector<std::int8_t>, std::vector<std::uint8_t>,
                 std::vector<std::int16_t>, std::vector<std::uint16_t>, std::vector<std::int32_t>,
                 std::vector<std::uint32_t>>;

/// A named attribute: `components` scalars for each element, one element after another.
/// Names with a meaning everywhere: "normal" (3 components), "uv" (2; v points up, as in OBJ), "color" (3 or
/// 4; 0..255 for uint8, 0..1 for float), "quality" (1), "material" and "group" (1, whole numbers that number
/// `labels`). Any other name is carried as it is.
struct VKMESH_API Channel {
  std::string name;
  unsigned components = 1;
  ChannelValues values;
  /// What the values 0, 1, … stand for, where they number names (OBJ's usemtl and g); else empty.
  std::vector<std::string> labels = {};

  /// Scalars held, elements × components.
  [[nodiscard]] std::size_t scalar_count() const {
    return std::visit([](const auto& v) { return v.size(); }, values);
  }
};

/// The channel of that name, or nullptr. O(channels).
[[nodiscard]] VKMESH_API const Channel* find_channel(const std::vector<Channel>& channels,
                                                     const std::string& name);

/// Replaces the channel of the same name, or appends.
VKMESH_API void set_channel(std::vector<Channel>& channels, Channel channel);

/// The elements `from` of a channel, in that order: what is left of it when elements are dropped, copied or
/// moved. O(from.size()).
[[nodiscard]] VKMESH_API Channel gather(const Channel& channel, std::span<const std::uint32_t> from);
/// The same for each of the channels.
[[nodiscard]] VKMESH_API std::vector<Channel> gather(const std::vector<Channel>& channels,
                                                     std::span<const std::uint32_t> from);

}  // namespace vkmesh
