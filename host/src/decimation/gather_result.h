// What is left after decimation, in the order of the input.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/mesh/handles.h>

#include "base/parallel.h"
#include "base/parallel_filter.h"
#include "base/prefetch.h"
#include "base/stop.h"
#include "decimation/cost/attribute_quadrics.h"
#include "decimation/decimation_state.h"
#include "decimation/setup/frame.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// O(n). `input_faces`: of the input. `in_order`: records stand in the order of the input, if not for all of
/// it; then the vertex map is that of the records, and else of the input, undefined where a vertex has none.
/// Errors: kInterrupted where the caller wants it; what has been done within a time is gathered.
template <class Point>
Result<BasicDecimated<Point>> gather(const CollapseMesh& mesh, std::span<const Point> points,
                                     std::size_t input_faces, bool in_order, const Frame& frame,
                                     const Outcome& outcome, const AttributeQuadrics* attributes,
                                     Stop& stop) {
  BasicDecimated<Point> result;
  result.stop = outcome.stop;
  result.collapses = outcome.collapses;
  result.error = std::sqrt(outcome.error2) / frame.scale;
  result.relative_error = frame.diagonal > 0 ? result.error / frame.diagonal : 0;
  if (frame.diagonal > 0)
    result.attribute_error = std::sqrt(outcome.attribute_error2) / (frame.diagonal * frame.scale);
  result.rejected = outcome.rejected;
  result.blocked = outcome.blocked;
  result.history.reserve(outcome.events.size());
  for (const Event& e : outcome.events)
    result.history.push_back(
        {e.kept, e.removed, e.moved ? point_of<Point>(e.position, frame) : points[e.kept], e.faces});

  VKMESH_CHECK(stop.check());

  // Vertices and faces in the order of the input. The records are read once; what follows is in small arrays.
  const auto& vertices = mesh.vertices;
  const std::size_t n = in_order ? mesh.apex() : points.size(),
                    faces = in_order ? mesh.face_count() : input_faces;
  constexpr std::size_t kGrain = std::size_t{1} << 15;
  constexpr std::uint32_t kMask = VertexRecord::kSourceMask;
  const auto source_of = [&](std::uint32_t v) { return in_order ? v : vertices[v].source & kMask; };
  const auto source_of_face = [&](std::uint32_t f) { return in_order ? f : mesh.face(4 * f).source; };
  // The numbers in the order of the input of records, whose own numbers these are.
  const auto in_input_order = [&](const std::vector<std::uint32_t>& records, std::size_t count,
                                  auto&& source) {
    if (in_order) return records;
    std::vector<bool> is(count, false);
    for (const std::uint32_t r : records) is[source(r)] = true;
    std::vector<std::uint32_t> sources;
    sources.reserve(records.size());
    for (std::uint32_t i = 0; i < count; ++i)
      if (is[i]) sources.push_back(i);
    return sources;
  };
  // For each vertex of the input the one that absorbed it; in the end the one that stands for it, or itself.
  std::vector<std::uint32_t> by(n);
  const std::vector<std::uint32_t> alive = collect(mesh.apex(), [&](std::uint32_t v) {
    const VertexRecord& vertex = vertices[v];
    prefetch_stream(&vertex);
    const std::uint32_t source = source_of(v);
    const bool absorbed = !vertex.alive() && vertex.leading != kInvalid;
    by[source] = absorbed ? source_of(vertex.leading & ~VertexRecord::kGone) : source;
    return vertex.alive();
  });
  result.source_vertex = in_input_order(alive, n, source_of);
  VKMESH_CHECK(stop.check());
  // Each looks at others that another thread may be changing: all come to the same end.
  const auto follow = [&](std::size_t begin, std::size_t end) {
    std::uint32_t change = 0;
    for (std::size_t v = begin; v < end; ++v) {
      const std::atomic_ref<std::uint32_t> mine(by[v]);
      const std::uint32_t b = mine.load(std::memory_order_relaxed);
      const std::uint32_t next = std::atomic_ref(by[b]).load(std::memory_order_relaxed);
      change |= b ^ next;
      mine.store(next, std::memory_order_relaxed);
    }
    return std::size_t{change != 0 ? 1u : 0u};
  };
  while (parallel_sum<std::size_t>(n, kGrain, follow) > 0) {
  }
  std::vector<std::uint32_t> new_vertex(n, kInvalid);
  for (std::uint32_t i = 0; i < result.source_vertex.size(); ++i) new_vertex[result.source_vertex[i]] = i;
  result.vertex_map.resize(n);
  parallel_ranges(n, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) result.vertex_map[v] = new_vertex[by[v]];
  });
  by = std::vector<std::uint32_t>();
  VKMESH_CHECK(stop.check());
  result.positions.resize(alive.size());
  for (const std::uint32_t v : alive) {
    const VertexRecord& vertex = vertices[v];
    result.positions[new_vertex[source_of(v)]] = vertex.has(VertexRecord::kMoved)
                                                     ? point_of<Point>(vertex.position, frame)
                                                     : points[vertex.source & kMask];
  }
  VKMESH_CHECK(stop.check());

  const std::vector<std::uint32_t> alive_faces = collect(mesh.face_count(), [&](std::uint32_t f) {
    prefetch_stream(&mesh.face(4 * f));
    return mesh.alive(4 * f);
  });
  result.source_face = in_input_order(alive_faces, faces, source_of_face);
  VKMESH_CHECK(stop.check());
  const auto new_face_of = std::make_unique_for_overwrite<std::uint32_t[]>(faces);  // of those alive
  const std::span new_face(new_face_of.get(), faces);
  for (std::uint32_t i = 0; i < result.source_face.size(); ++i) new_face[result.source_face[i]] = i;
  if (attributes != nullptr) result.attributes = attributes->gather(alive_faces, new_face);
  VKMESH_CHECK(stop.check());
  const bool all_alive = in_order && alive_faces.size() == faces;  // each is where it was
  std::vector<std::uint32_t> origin(3 * result.source_face.size()), twin(origin.size());
  parallel_ranges(alive_faces.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
    constexpr std::size_t kAhead = 16;
    for (std::size_t k = begin; k < end; ++k) {
      prefetch(&mesh.face(4 * alive_faces[std::min(k + kAhead, end - 1)]));
      const CollapseMesh::Face& face = mesh.face(4 * alive_faces[k]);
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t f = source_of_face(alive_faces[k]);
        const std::uint32_t h = 3 * new_face[f] + i, t = face.twin[i];
        origin[h] = new_vertex[source_of(face.origin[i])];
        twin[h] = mesh.is_ghost(t) ? kInvalid
                  : all_alive      ? t - t / 4
                                   : 3 * new_face[source_of_face(t / 4)] + t % 4;
      }
    }
  });
  VKMESH_CHECK(stop.check());
  result.mesh = HalfEdgeMesh::from_twins(std::move(origin), std::move(twin), result.positions.size());
  if (in_order && (n < points.size() || faces < input_faces)) {
    for (std::uint32_t& v : result.source_vertex) v = vertices[v].source & kMask;
    for (std::uint32_t& f : result.source_face) f = mesh.face(4 * f).source;
  }
  return result;
}

}  // namespace vkmesh::detail
