// The result where the time is over before anything was removed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/handles.h>

#include "decimation/setup/prepare.h"

namespace vkmesh::detail {

/// The wedges of a mesh as they are, numbered as their corners come; `options` have attributes or groups.
inline void name_wedges(const HalfEdgeMesh& mesh, const DecimateOptions& options,
                        DecimatedAttributes& attributes) {
  std::vector<std::uint32_t>& wedge = attributes.corners;
  wedge.assign(mesh.half_edge_count(), kInvalid);
  const auto clockwise = [&](HalfEdgeId h) {
    return mesh.is_boundary(h) ? HalfEdgeId{} : mesh.next(mesh.twin(h));
  };
  for (std::uint32_t c = 0; c < wedge.size(); ++c) {
    if (wedge[c] != kInvalid) continue;
    const auto number = static_cast<std::uint32_t>(attributes.source_corner.size());
    attributes.source_corner.push_back(c);
    wedge[c] = number;
    const auto spread = [&](auto&& next) {
      for (HalfEdgeId from(c), to = next(from);
           to.valid() && wedge[to.index] == kInvalid && have_same_values(options, from.index, to.index);
           from = to, to = next(to))
        wedge[to.index] = number;
    };
    spread([&](HalfEdgeId h) { return mesh.around_vertex(h); });
    spread(clockwise);
  }
  for (const DecimateAttribute& a : options.attributes) {
    std::vector<float>& values = attributes.values.emplace_back();
    values.reserve(attributes.source_corner.size() * a.components);
    for (const std::uint32_t c : attributes.source_corner) {
      const auto value = a.value(a.corners.empty() ? mesh.origin(HalfEdgeId(c)).index : a.corners[c]);
      values.insert(values.end(), value.begin(), value.end());
    }
  }
}

/// The input without its isolated vertices, as decimate() gives what it has not changed. O(n).
template <class Point>
BasicDecimated<Point> unchanged(HalfEdgeMesh mesh, std::span<const Point> points,
                                const DecimateOptions& options) {
  BasicDecimated<Point> result;
  result.stop = DecimateStop::kTimeLimit;
  if (options.bounds.distance || options.bounds.report_distance) result.distance_bound = 0;
  if (!options.attributes.empty() || !options.corner_groups.empty()) {
    name_wedges(mesh, options, result.attributes);
    if (options.keep_history) {
      result.changes.values.resize(options.attributes.size());
      for (const std::uint32_t w : result.attributes.corners)
        result.changes.corners.push_back(result.attributes.source_corner[w]);
    }
  }
  result.source_face.resize(mesh.face_count());
  std::iota(result.source_face.begin(), result.source_face.end(), 0u);
  result.vertex_map.assign(points.size(), kInvalid);
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    if (mesh.is_isolated(VertexId(v))) continue;
    result.vertex_map[v] = static_cast<std::uint32_t>(result.source_vertex.size());
    result.source_vertex.push_back(v);
    result.positions.push_back(points[v]);
  }
  if (result.positions.size() == points.size()) {
    result.mesh = std::move(mesh);
    return result;
  }
  std::vector<std::uint32_t> origin(mesh.origins().begin(), mesh.origins().end()),
      twin(mesh.twins().begin(), mesh.twins().end());
  for (std::uint32_t& v : origin) v = result.vertex_map[v];
  result.mesh = HalfEdgeMesh::from_twins(std::move(origin), std::move(twin), result.positions.size());
  return result;
}

}  // namespace vkmesh::detail
