// What the tests of decimation share.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/decimation/decimate.h>

#include "decimation/vertex_record.h"
#include "mesh/edit_mesh_support.h"
#include "support/shapes.h"

namespace vkmesh::test {

template <class Point>
BasicDecimated<Point> run(const HalfEdgeMesh& mesh, const std::vector<Point>& points,
                          const DecimateOptions& options) {
  auto result = decimate(mesh, std::span<const Point>(points), options);
  if (!result) FAIL(result.error().describe());
  if (const auto valid = validate(result->mesh); !valid) FAIL(valid.error().describe());
  return std::move(*result);
}
inline Decimated run(const IndexedFaceSet& mesh, const DecimateOptions& options) {
  return run(half_edges(mesh), mesh.points, options);
}

/// Edge collapse, half-edge collapse and vertex removal.
inline std::vector<DecimateOptions> ways() {
  std::vector<DecimateOptions> all(3);
  all[1].operation = DecimateOperation::kHalfEdgeCollapse;
  all[2].operation = DecimateOperation::kVertexRemoval;
  return all;
}

/// How many candidates are blocked, whatever the reason.
inline std::size_t sum(const CountByReason& counts) {
  return std::accumulate(counts.counts.begin(), counts.counts.end(), std::size_t{0});
}

/// As decimation begins with it: quadrics of nothing, and the apex nowhere.
inline detail::CollapseMesh collapse_mesh_of(const IndexedFaceSet& set) {
  auto mesh = edit_mesh_of<detail::VertexRecord>(set);
  for (std::uint32_t v = 0; v < set.points.size(); ++v) {
    mesh.vertices[v].position = {set.points[v].x, set.points[v].y, set.points[v].z};
    mesh.vertices[v].source = v;
  }
  mesh.vertices[mesh.apex()] = {};
  mesh.vertices[mesh.apex()].position.fill(std::numeric_limits<float>::quiet_NaN());
  return mesh;
}

/// Fitted into the cube that partitions are split in.
inline IndexedFaceSet fitted(IndexedFaceSet set) {
  float size = 0;
  for (const Vec3& p : set.points) size = std::max({size, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  for (Vec3& p : set.points) p = 0.5f / size * p;
  return set;
}

/// The neighbours of a vertex, counter-clockwise; that to which its half-edge leads is the last.
inline std::vector<std::uint32_t> ring_of(const detail::CollapseMesh& mesh, std::uint32_t v) {
  std::vector<std::uint32_t> ring;
  std::uint32_t h = mesh.vertices[v].leading;
  do {
    h = mesh.around_vertex(h);
    ring.push_back(mesh.target(h));
  } while (h != mesh.vertices[v].leading);
  return ring;
}

}  // namespace vkmesh::test
