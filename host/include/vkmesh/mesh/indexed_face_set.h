// Points, and polygons that index them: a mesh as files hold it, unjudged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/channel.h>

namespace vkmesh {

/// An indexed face set (Akenine-Möller & Haines, ch. 12): may hold anything a file can hold — non-manifold
/// edges, isolated points, degenerate faces. `consolidate` judges it. A point cloud is one without faces.
struct VKMESH_API IndexedFaceSet {
  std::vector<Vec3> points;
  /// Point index of every corner, face after face. Readers guarantee that each is < points.size().
  std::vector<std::uint32_t> corners;
  /// Empty: every face is a triangle. Else face_count() + 1 entries: face f has the corners
  /// [face_offsets[f], face_offsets[f + 1]).
  std::vector<std::uint32_t> face_offsets;

  std::vector<Channel> point_channels;   ///< One element per point.
  std::vector<Channel> corner_channels;  ///< One element per corner.
  std::vector<Channel> face_channels;    ///< One element per face.

  [[nodiscard]] std::size_t face_count() const {
    return face_offsets.empty() ? corners.size() / 3 : face_offsets.size() - 1;
  }
  [[nodiscard]] bool is_triangles() const { return face_offsets.empty(); }
  /// Corners of face f, in order. O(1).
  [[nodiscard]] std::span<const std::uint32_t> face(std::size_t f) const {
    if (face_offsets.empty()) return {corners.data() + 3 * f, 3};
    return {corners.data() + face_offsets[f], face_offsets[f + 1] - face_offsets[f]};
  }

  /// Drops face_offsets when all faces are triangles, so that there is one form for each mesh. O(faces).
  void normalize_offsets();
};

}  // namespace vkmesh
