#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/mesh/triangulate.h>

#include "mesh/ear_clipper.h"

namespace vkmesh {
namespace {

Triangulated cut(const IndexedFaceSet& mesh) {
  Triangulated result;
  result.mesh.points = mesh.points;
  result.mesh.point_channels = mesh.point_channels;
  if (mesh.is_triangles()) {
    result.mesh = mesh;
    result.source_face.resize(mesh.face_count());
    std::iota(result.source_face.begin(), result.source_face.end(), 0u);
    return result;
  }

  const bool keep_corners = !mesh.corner_channels.empty();
  std::vector<std::uint32_t> source_corner;
  detail::EarClipper clipper;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::span<const std::uint32_t> corners = mesh.face(f);
    const auto emit = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
      for (const std::uint32_t place : {i, j, k}) {
        result.mesh.corners.push_back(corners[place]);
        if (keep_corners) source_corner.push_back(mesh.face_offsets[f] + place);
      }
      result.source_face.push_back(static_cast<std::uint32_t>(f));
    };
    if (corners.size() == 3)
      emit(0, 1, 2);
    else if (corners.size() > 3)
      clipper.clip(mesh.points, corners, emit);
  }
  result.mesh.corner_channels = gather(mesh.corner_channels, source_corner);
  result.mesh.face_channels = gather(mesh.face_channels, result.source_face);
  return result;
}

}  // namespace

Result<Triangulated> triangulate(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<Triangulated> { return cut(mesh); });
}

}  // namespace vkmesh
