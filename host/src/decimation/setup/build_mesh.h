// The mesh that decimation works on: in local coordinates, and in an order with locality.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <vkmesh/base/result.h>

#include "base/counting_sort.h"
#include "base/parallel.h"
#include "base/prefetch.h"
#include "base/stop.h"
#include "decimation/setup/frame.h"
#include "decimation/vertex_record.h"
#include "spatial/morton_order.h"

namespace vkmesh::detail {

inline constexpr const char* kNoManifold = "decimation takes oriented manifolds only: consolidate first";

struct BuiltMesh {
  CollapseMesh mesh;
  Frame frame;
  std::size_t used_vertices = 0;
  bool is_in_order = true;  // vertices and faces are numbered as in the input
};

/// Builds a mesh whose vertices, and faces by their first vertex, go along Morton's curve; `order` tells
/// their numbers in the input.
template <class Position>
CollapseMesh::Built build_along_curve(CollapseMesh& mesh, std::size_t vertex_count,
                                      std::span<const std::uint32_t> corners, Position&& position,
                                      std::vector<std::uint32_t>& order, std::vector<std::uint32_t>& leading,
                                      Stop& stop) {
  order = morton_order(vertex_count, position);
  if (!goes_on(&stop)) return CollapseMesh::Built::kStopped;
  const std::size_t faces = corners.size() / 3;
  std::vector<std::uint32_t> rank(vertex_count), first(faces), face_order(faces);
  for (std::uint32_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
  const auto ranks_of = [&](std::size_t f) -> std::array<std::uint32_t, 3> {
    return {rank[corners[3 * f]], rank[corners[3 * f + 1]], rank[corners[3 * f + 2]]};
  };
  parallel_ranges(faces, 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) first[f] = std::ranges::min(ranks_of(f));
  });
  counting_sort(
      vertex_count, faces, [&](std::size_t f) { return first[f]; },
      [&](std::size_t slot, std::size_t f) { face_order[slot] = static_cast<std::uint32_t>(f); });
  first = std::vector<std::uint32_t>();
  if (!goes_on(&stop)) return CollapseMesh::Built::kStopped;
  const auto face_of = [&](std::size_t f) {
    return CollapseMesh::Face{ranks_of(face_order[f]), 0, {}, face_order[f]};
  };
  return mesh.build(vertex_count, faces, face_of, leading, &stop);
}

/// Connects faces given by three corners each, gives the vertices that they use local positions, and orders
/// both along Morton's curve where the input's order has no locality. O(n). Errors: kUsage for corners that
/// are no multiple of three or name no point; kUnsuitable where the mesh is too large, no oriented manifold
/// or not finite; kInterrupted where `stop` is set meanwhile.
template <class Point>
Result<BuiltMesh> build_mesh(std::span<const Point> points, std::span<const std::uint32_t> corners,
                             Stop& stop) {
  if (corners.size() % 3 != 0) return fail(ErrorCode::kUsage, "decimation takes three corners a face");
  if (corners.size() / 3 > CollapseMesh::kMaxFaces || points.size() > CollapseMesh::kMaxVertices)
    return fail(ErrorCode::kUnsuitable,
                "decimation takes at most 2^28 vertices, 2^29 faces and boundary edges");
  BuiltMesh result;
  CollapseMesh& mesh = result.mesh;
  Frame& frame = result.frame;
  std::vector<std::uint32_t> order, leading;
  auto built = CollapseMesh::Built::kNoSuchVertex;
  if (!lacks_locality(points.size(), corners)) {
    const auto face_of = [&](std::size_t f) {
      return CollapseMesh::Face{
          {corners[3 * f], corners[3 * f + 1], corners[3 * f + 2]}, 0, {}, static_cast<std::uint32_t>(f)};
    };
    built = mesh.build(points.size(), corners.size() / 3, face_of, leading, &stop);
    if (built == CollapseMesh::Built::kDone) {
      VKMESH_TRY(frame, frame_of(points, [&](std::size_t v) { return leading[v] != kInvalid; }));
    }
  } else if (std::ranges::all_of(corners, [&](std::uint32_t c) { return c < points.size(); })) {
    std::vector<std::uint8_t> in_use(points.size(), 0);
    for (const std::uint32_t c : corners) in_use[c] = 1;
    VKMESH_TRY(frame, frame_of(points, [&](std::size_t v) { return in_use[v] != 0; }));
    in_use = {};
    VKMESH_CHECK(stop.go_on());
    const auto local = [&](std::size_t v) { return local_of(points[v], frame); };
    built = build_along_curve(mesh, points.size(), corners, local, order, leading, stop);
    result.is_in_order = false;
  }
  VKMESH_CHECK(stop.go_on());
  if (built == CollapseMesh::Built::kNoSuchVertex) return fail(ErrorCode::kUsage, "a corner names no point");
  if (built == CollapseMesh::Built::kNoManifold) return fail(ErrorCode::kUnsuitable, kNoManifold);

  constexpr std::size_t kGrain = 1 << 14;
  result.used_vertices =
      parallel_sum<std::size_t>(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        if (!goes_on(&stop)) return count;
        for (std::size_t v = begin; v < end; ++v) {
          VertexRecord& vertex = mesh.vertices[v];
          prefetch_stream(&vertex);
          const std::uint32_t source = order.empty() ? static_cast<std::uint32_t>(v) : order[v];
          vertex = {};
          vertex.position = local_of(points[source], frame);
          vertex.leading = leading[v];
          vertex.source = source;
          count += leading[v] != kInvalid ? 1 : 0;
        }
        return count;
      });
  VKMESH_CHECK(stop.go_on());
  VertexRecord& apex = mesh.vertices[mesh.apex()];
  apex = {};
  apex.position.fill(std::numeric_limits<float>::quiet_NaN());  // it lies nowhere
  apex.source = VertexRecord::kLocked;                          // which tells rings at the boundary
  return result;
}

}  // namespace vkmesh::detail
