// What is left after decimation, in the order of the input.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/handles.h>

#include "decimation/attribute_quadrics.h"
#include "decimation/collapse_mesh.h"
#include "decimation/driver.h"
#include "decimation/frame.h"
#include "parallel.h"

namespace vkmesh::detail {

/// The numbers below `count` that f(number) is true for, in ascending order; f is called on any threads.
template <class F>
std::vector<std::uint32_t> collect(std::size_t count, F&& f) {
  struct List {
    std::vector<std::uint32_t> all;
    List& operator+=(const List& after) {
      all.insert(all.end(), after.all.begin(), after.all.end());
      return *this;
    }
  };
  return parallel_sum<List>(count, 1 << 15,
                            [&](std::size_t begin, std::size_t end) {
                              List list;
                              for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
                                if (f(i)) list.all.push_back(i);
                              return list;
                            })
      .all;
}

template <class Point>
BasicDecimated<Point> gather(const CollapseMesh& mesh, std::span<const Point> points, bool in_order,
                             const Frame& frame, const Outcome& outcome,
                             const AttributeQuadrics* attributes) {
  BasicDecimated<Point> result;
  result.stop = outcome.stop;
  result.collapses = outcome.collapses;
  result.error = std::sqrt(outcome.error2) / frame.scale;
  result.relative_error = frame.diagonal > 0 ? result.error / frame.diagonal : 0;
  if (frame.diagonal > 0)
    result.attribute_error = std::sqrt(outcome.attribute_error2) / (frame.diagonal * frame.scale);
  const auto rejected = [&](Legality why) { return outcome.rejected[static_cast<std::size_t>(why)]; };
  result.rejected_link = rejected(Legality::kLink);
  result.rejected_fold_over = rejected(Legality::kFoldOver);
  result.rejected_error = rejected(Legality::kError);
  result.rejected_locked = rejected(Legality::kLocked);
  result.rejected_seam = rejected(Legality::kSeam);
  result.rejected_criterion = rejected(Legality::kCriterion);
  const auto held = [&](Legality why) { return outcome.held[static_cast<std::size_t>(why)]; };
  result.held = {held(Legality::kLink),     held(Legality::kFoldOver),
                 held(Legality::kError),    held(Legality::kLocked) - outcome.held_by_boundary,
                 outcome.held_by_boundary,  held(Legality::kSeam),
                 held(Legality::kCriterion)};
  result.history.reserve(outcome.events.size());
  for (const Event& e : outcome.events)
    result.history.push_back(
        {e.kept, e.removed, e.moved ? point_of<Point>(e.position, frame) : points[e.kept], e.faces});

  // Vertices and faces in the order of the input. The records are read once; what follows is in small arrays.
  const auto& vertices = mesh.vertices;
  const std::size_t n = points.size();
  constexpr std::uint32_t kMask = CollapseVertex::kSourceMask;
  const auto source_of = [&](std::uint32_t v) { return in_order ? v : vertices[v].source & kMask; };
  std::vector<std::uint32_t>& new_vertex = result.vertex_map;
  new_vertex.assign(n, kInvalid);
  std::vector<std::uint32_t> absorbed(n, kInvalid);  // by which vertex, both of the input
  const std::vector<std::uint32_t> alive = collect(n, [&](std::uint32_t v) {
    const CollapseVertex& vertex = vertices[v];
    if (vertex.alive()) {
      new_vertex[vertex.source & kMask] = 0;
    } else if (vertex.leading != kInvalid) {
      const std::uint32_t by = vertex.leading & ~CollapseVertex::kGone;
      absorbed[vertex.source & kMask] = source_of(by);
    }
    return vertex.alive();
  });
  for (std::uint32_t v = 0; v < n; ++v) {
    if (new_vertex[v] == kInvalid) continue;
    new_vertex[v] = static_cast<std::uint32_t>(result.source_vertex.size());
    result.source_vertex.push_back(v);
  }
  result.positions.resize(alive.size());
  for (const std::uint32_t v : alive) {
    const CollapseVertex& vertex = vertices[v];
    const std::uint32_t source = vertex.source & kMask;
    result.positions[new_vertex[source]] =
        vertex.has(CollapseVertex::kMoved) ? point_of<Point>(vertex.position, frame) : points[source];
  }
  // Each vertex that went is found with the one that stands for it in the end.
  std::vector<std::uint32_t> path;
  for (std::uint32_t v = 0; v < n; ++v) {
    std::uint32_t at = v;
    path.clear();
    while (absorbed[at] != kInvalid) {
      path.push_back(at);
      at = absorbed[at];
    }
    for (const std::uint32_t gone : path) {
      absorbed[gone] = kInvalid;
      new_vertex[gone] = new_vertex[at];
    }
  }

  std::vector<std::uint32_t> new_face(mesh.face_count(), kInvalid);
  const std::vector<std::uint32_t> alive_faces = collect(mesh.face_count(), [&](std::uint32_t f) {
    const CollapseMesh::Face& face = mesh.face(4 * f);
    if (face.alive()) new_face[face.source] = 0;
    return face.alive();
  });
  for (std::uint32_t f = 0; f < new_face.size(); ++f) {
    if (new_face[f] == kInvalid) continue;
    new_face[f] = static_cast<std::uint32_t>(result.source_face.size());
    result.source_face.push_back(f);
  }
  if (attributes != nullptr) result.attributes = attributes->gather(alive_faces, new_face);
  std::vector<std::uint32_t> origin(3 * result.source_face.size()), twin(origin.size()),
      leading(result.positions.size(), kInvalid);
  parallel_ranges(alive_faces.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const CollapseMesh::Face& face = mesh.face(4 * alive_faces[k]);
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t h = 3 * new_face[face.source] + i, t = face.twin[i];
        origin[h] = new_vertex[source_of(face.origin[i])];
        twin[h] = mesh.is_ghost(t) ? kInvalid : 3 * new_face[mesh.face(t).source] + t % 4;
      }
    }
  });
  for (std::uint32_t h = 0; h < origin.size(); ++h)
    if (leading[origin[h]] == kInvalid || twin[h] == kInvalid) leading[origin[h]] = h;
  result.mesh = HalfEdgeMesh::from_arrays(std::move(origin), std::move(twin), std::move(leading));
  return result;
}

}  // namespace vkmesh::detail
