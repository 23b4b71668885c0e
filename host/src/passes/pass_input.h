// What every pass asks of its input.
#pragma once

#include <span>
#include <string>

#include <vkmesh/base/result.h>
#include <vkmesh/math/arithmetic.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh::detail {

inline Result<void> require_triangles(const HalfEdgeMesh& mesh, const char* pass) {
  if (mesh.is_triangles()) return {};
  return fail(ErrorCode::kUnsuitable,
              std::string(pass) + " takes triangles only: triangulate the polygons first");
}

inline Result<void> require_positions(std::span<const Vec3> positions, std::size_t vertices) {
  if (positions.size() == vertices) return check_positions(positions);
  return fail(ErrorCode::kUsage,
              std::to_string(positions.size()) + " positions for " + std::to_string(vertices) + " vertices");
}

inline Result<void> require_size(std::span<const Vec3> normals, std::size_t size, const char* of) {
  if (normals.size() == size) return {};
  return fail(ErrorCode::kUsage, "room for " + std::to_string(normals.size()) + " normals of " +
                                     std::to_string(size) + " " + of);
}

}  // namespace vkmesh::detail
