#include <algorithm>
#include <string>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/mesh/half_edge_mesh.h>

#include "mesh/edge_matching.h"

namespace vkmesh {

HalfEdgeMesh HalfEdgeMesh::from_arrays(std::vector<std::uint32_t> origin, std::vector<std::uint32_t> twin,
                                       std::vector<std::uint32_t> leading,
                                       std::vector<std::uint32_t> face_offsets) {
  HalfEdgeMesh mesh;
  mesh.origin_ = std::move(origin);
  mesh.twin_ = std::move(twin);
  mesh.leading_ = std::move(leading);
  mesh.face_offsets_ = std::move(face_offsets);
  if (!mesh.face_offsets_.empty()) {
    mesh.face_.resize(mesh.origin_.size());
    for (std::size_t f = 0; f + 1 < mesh.face_offsets_.size(); ++f)
      for (std::size_t h = mesh.face_offsets_[f]; h < mesh.face_offsets_[f + 1] && h < mesh.face_.size(); ++h)
        mesh.face_[h] = static_cast<std::uint32_t>(f);
  }
  return mesh;
}

HalfEdgeMesh HalfEdgeMesh::from_twins(std::vector<std::uint32_t> origin, std::vector<std::uint32_t> twin,
                                      std::size_t vertex_count) {
  std::vector<std::uint32_t> leading = detail::leading_half_edges(vertex_count, origin, twin);
  return from_arrays(std::move(origin), std::move(twin), std::move(leading));
}

std::size_t HalfEdgeMesh::boundary_half_edge_count() const {
  return static_cast<std::size_t>(std::count(twin_.begin(), twin_.end(), kInvalid));
}

std::size_t HalfEdgeMesh::edge_count() const {
  return (half_edge_count() + boundary_half_edge_count()) / 2;
}

HalfEdgeId HalfEdgeMesh::find_half_edge(VertexId a, VertexId b) const {
  for (const HalfEdgeId h : half_edges_around(a))
    if (target(h) == b) return h;
  return {};
}

std::vector<std::vector<HalfEdgeId>> HalfEdgeMesh::boundary_loops() const {
  std::vector<std::vector<HalfEdgeId>> loops;
  std::vector<bool> seen(half_edge_count(), false);
  for (std::uint32_t i = 0; i < half_edge_count(); ++i) {
    if (twin_[i] != kInvalid || seen[i]) continue;
    auto& loop = loops.emplace_back();
    for (HalfEdgeId h(i); !seen[h.index]; h = next_on_boundary(h)) {
      seen[h.index] = true;
      loop.push_back(h);
    }
  }
  return loops;
}

namespace {

tl::unexpected<Error> broken(const char* invariant, const char* element, std::size_t index) {
  return fail(ErrorCode::kInternal, std::string("half-edge mesh: ") + invariant + " (" + element + " " +
                                        std::to_string(index) + ")");
}

}  // namespace

Result<void> validate(const HalfEdgeMesh& mesh) {
  return detail::catching([&]() -> Result<void> {
    const auto origin = mesh.origins(), twin = mesh.twins(), leading = mesh.leadings();
    const auto offsets = mesh.face_offsets(), faces = mesh.faces();
    const std::size_t half_edges = origin.size(), vertices = leading.size();
    if (twin.size() != half_edges) return broken("one twin for each half-edge", "twins", twin.size());
    if (offsets.empty()) {
      if (half_edges % 3 != 0) return broken("three half-edges for each triangle", "half-edges", half_edges);
    } else {
      if (offsets.front() != 0 || offsets.back() != half_edges || faces.size() != half_edges)
        return broken("face offsets run from 0 to the number of half-edges", "offset", offsets.back());
      for (std::size_t f = 0; f + 1 < offsets.size(); ++f)
        if (offsets[f + 1] < offsets[f] + 3 || offsets[f + 1] > half_edges)
          return broken("a face has three or more half-edges", "face", f);
      for (std::size_t f = 0; f + 1 < offsets.size(); ++f)
        for (std::size_t h = offsets[f]; h < offsets[f + 1]; ++h)
          if (faces[h] != f) return broken("a half-edge names its face", "half-edge", h);
    }
    std::vector<std::uint32_t> degree(vertices, 0);
    for (std::size_t h = 0; h < half_edges; ++h) {
      if (origin[h] >= vertices) return broken("an origin is a vertex", "half-edge", h);
      if (twin[h] != kInvalid && twin[h] >= half_edges)
        return broken("a twin is a half-edge", "half-edge", h);
      ++degree[origin[h]];
    }
    std::vector<std::uint32_t> seen_in(vertices, kInvalid);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      for (const VertexId v : mesh.vertices_around(FaceId(f))) {
        if (seen_in[v.index] == f) return broken("a face repeats no vertex", "face", f);
        seen_in[v.index] = f;
      }
    for (std::uint32_t h = 0; h < half_edges; ++h) {
      if (twin[h] == kInvalid) continue;
      if (twin[h] == h || twin[twin[h]] != h) return broken("twins are mutual", "half-edge", h);
      if (mesh.target(HalfEdgeId(h)) != mesh.origin(mesh.twin(HalfEdgeId(h))) ||
          mesh.target(mesh.twin(HalfEdgeId(h))) != mesh.origin(HalfEdgeId(h)))
        return broken("twins run in opposite directions", "half-edge", h);
    }
    std::vector<std::uint32_t> reached_from(vertices, kInvalid);
    for (std::uint32_t v = 0; v < vertices; ++v) {
      const HalfEdgeId start(leading[v]);
      if (!start.valid()) {
        if (degree[v] != 0) return broken("a vertex with faces has a leading half-edge", "vertex", v);
        continue;
      }
      if (start.index >= half_edges || origin[start.index] != v)
        return broken("a leading half-edge leaves its vertex", "vertex", v);
      std::uint32_t met = 0;
      HalfEdgeId h = start, last = start;
      do {
        ++met;
        last = h;
        if (reached_from[mesh.target(h).index] == v)
          return broken("no edge is used twice", "half-edge", h.index);
        reached_from[mesh.target(h).index] = v;
        h = mesh.around_vertex(h);
      } while (h.valid() && h != start && met <= degree[v]);
      if (h.valid() && h != start) return broken("a fan closes", "vertex", v);
      if (!h.valid()) {
        if (twin[start.index] != kInvalid) return broken("a leading half-edge starts its fan", "vertex", v);
        if (reached_from[mesh.origin(mesh.previous(last)).index] == v)
          return broken("no edge is used twice", "half-edge", mesh.previous(last).index);
      }
      if (met != degree[v]) return broken("the faces of a vertex form one fan", "vertex", v);
    }
    return {};
  });
}

}  // namespace vkmesh
