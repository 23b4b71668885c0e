#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/analysis/topology.h>
#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/mesh/handles.h>

#include "base/disjoint_sets.h"
#include "base/distinct_rows.h"
#include "mesh/duplicate_faces.h"
#include "mesh/edge_records.h"

namespace vkmesh {
namespace {

/// Sets of faces with, for each face, whether it runs the same way as the face that stands for its set.
class OrientedSets {
 public:
  explicit OrientedSets(std::size_t faces) : parent_(faces), turned_(faces, 0), conflict_(faces, 0) {
    for (std::uint32_t f = 0; f < faces; ++f) parent_[f] = f;
  }

  std::pair<std::uint32_t, bool> find(std::uint32_t f) {
    bool turned = false;
    std::uint32_t root = f;
    while (parent_[root] != root) {
      turned ^= turned_[root] != 0;
      root = parent_[root];
    }
    // Compression: every face of the path learns its root.
    bool rest = turned;
    while (parent_[f] != root && f != root) {
      const std::uint32_t next = parent_[f];
      const bool own = turned_[f] != 0;
      parent_[f] = root;
      turned_[f] = rest;
      rest ^= own;
      f = next;
    }
    return {root, turned};
  }

  /// Says that two faces agree in orientation, or that they do not.
  void relate(std::uint32_t f, std::uint32_t g, bool agree) {
    auto [a, turned_a] = find(f);
    auto [b, turned_b] = find(g);
    const bool turned = turned_a ^ turned_b ^ !agree;
    if (a == b) {
      if (turned) conflict_[a] = 1;
      return;
    }
    if (b < a) std::swap(a, b);
    parent_[b] = a;
    turned_[b] = turned;
    conflict_[a] |= conflict_[b];
  }

  /// The faces of the set cannot all agree. `root` is what find() gave.
  bool conflict(std::uint32_t root) const { return conflict_[root] != 0; }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> turned_, conflict_;
};

class Analysis {
 public:
  explicit Analysis(const IndexedFaceSet& mesh)
      : mesh_(mesh),
        face_of_(mesh),
        oriented_(mesh.face_count()),
        joined_(mesh.face_count()),
        fans_(mesh.corners.size()) {
    degenerate_.resize(mesh.face_count());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      degenerate_[f] = detail::is_degenerate(mesh.face(f));
  }

  SurfaceTopology run() {
    collect_edges();
    number_components();
    for (const Edge& edge : edges_) count_edge(edge);
    count_fans();
    count_loops();
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f)
      if (!degenerate_[f]) ++component(f).faces;
    for (Topology& t : result_.components) {
      if (t.manifold() && t.orientable)
        t.genus = (2 - static_cast<std::int64_t>(t.boundary_loops) - t.euler_characteristic()) / 2;
      Topology& whole = result_.whole;
      whole.edges += t.edges;
      whole.faces += t.faces;
      whole.boundary_edges += t.boundary_edges;
      whole.boundary_loops += t.boundary_loops;
      whole.non_manifold_edges += t.non_manifold_edges;
      whole.misoriented_edges += t.misoriented_edges;
      whole.orientable = whole.orientable && t.orientable;
    }
    Topology& whole = result_.whole;
    if (whole.manifold() && whole.orientable && !result_.components.empty()) {
      whole.genus = 0;
      for (const Topology& t : result_.components) *whole.genus += *t.genus;
    }
    return std::move(result_);
  }

 private:
  struct Edge {
    std::uint32_t half_edge;  ///< The first that runs along it.
    std::uint32_t uses;
    bool misoriented;
  };

  std::uint32_t next(std::uint32_t h) const {
    if (mesh_.is_triangles()) return h % 3 == 2 ? h - 2 : h + 1;
    const std::uint32_t f = face_of_(h);
    return h + 1 == mesh_.face_offsets[f + 1] ? mesh_.face_offsets[f] : h + 1;
  }
  /// The corner of half-edge h's face at that of its ends.
  std::uint32_t corner_at(std::uint32_t h, std::uint32_t point) const {
    return mesh_.corners[h] == point ? h : next(h);
  }
  Topology& component(std::uint32_t face) { return result_.components[result_.component_of_face[face]]; }

  /// Finds the edges, and joins faces and corners across them.
  void collect_edges() {
    detail::EdgeRecords records =
        detail::distribute_edges(mesh_.points.size(), mesh_.corners, mesh_.face_offsets, mesh_.face_count());
    std::vector<std::uint32_t> sound;
    records.for_each_group(0, mesh_.points.size(), [&](std::uint32_t a, std::uint32_t b, auto uses) {
      sound.clear();
      for (const std::uint64_t use : uses)
        if (!degenerate_[face_of_(static_cast<std::uint32_t>(use))])
          sound.push_back(static_cast<std::uint32_t>(use));
      if (sound.empty()) return;
      const std::uint32_t h = sound[0];
      bool misoriented = false;
      for (std::size_t i = 1; i < sound.size(); ++i) joined_.unite(face_of_(h), face_of_(sound[i]));
      if (sound.size() == 2) {
        const std::uint32_t g = sound[1];
        misoriented = mesh_.corners[h] == mesh_.corners[g];
        oriented_.relate(face_of_(h), face_of_(g), !misoriented);
        fans_.unite(corner_at(h, a), corner_at(g, a));
        fans_.unite(corner_at(h, b), corner_at(g, b));
      }
      edges_.push_back({h, static_cast<std::uint32_t>(sound.size()), misoriented});
    });
  }

  void number_components() {
    result_.component_of_face.assign(mesh_.face_count(), kInvalid);
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      if (degenerate_[f]) continue;
      const std::uint32_t root = joined_.find(f);
      if (root == f) {
        result_.component_of_face[f] = static_cast<std::uint32_t>(result_.components.size());
        result_.components.emplace_back();
      } else {
        result_.component_of_face[f] = result_.component_of_face[root];
      }
      // One set of faces whose orientations are related may be a part of a component only.
      if (oriented_.conflict(oriented_.find(f).first)) component(f).orientable = false;
    }
  }

  void count_edge(const Edge& edge) {
    Topology& t = component(face_of_(edge.half_edge));
    ++t.edges;
    t.boundary_edges += edge.uses == 1 ? 1u : 0u;
    t.non_manifold_edges += edge.uses > 2 ? 1u : 0u;
    t.misoriented_edges += edge.misoriented ? 1u : 0u;
  }

  void count_fans() {
    struct Fan {
      std::uint32_t point, component;
    };
    std::vector<Fan> fans;
    for (std::uint32_t c = 0; c < mesh_.corners.size(); ++c)
      if (!degenerate_[face_of_(c)] && fans_.find(c) == c)
        fans.push_back({mesh_.corners[c], result_.component_of_face[face_of_(c)]});
    std::sort(fans.begin(), fans.end(), [](const Fan& a, const Fan& b) {
      return a.point != b.point ? a.point < b.point : a.component < b.component;
    });
    for (std::size_t i = 0; i < fans.size();) {
      std::size_t j = i;
      for (std::size_t k = i; j < fans.size() && fans[j].point == fans[i].point; k = j) {
        while (j < fans.size() && fans[j].point == fans[k].point && fans[j].component == fans[k].component)
          ++j;
        Topology& t = result_.components[fans[k].component];
        ++t.points;
        t.non_manifold_vertices += j - k > 1 ? 1u : 0u;
      }
      ++result_.whole.points;
      result_.whole.non_manifold_vertices += j - i > 1 ? 1u : 0u;
      i = j;
    }
  }

  /// An open fan has two ends; where both are boundary edges, these follow each other.
  void count_loops() {
    std::vector<std::uint32_t> boundary;
    for (const Edge& edge : edges_)
      if (edge.uses == 1) boundary.push_back(edge.half_edge);
    detail::DisjointSets loops(boundary.size());
    std::vector<std::uint32_t> end_of_fan(boundary.empty() ? 0 : mesh_.corners.size(), kInvalid);
    for (std::uint32_t i = 0; i < boundary.size(); ++i)
      for (const std::uint32_t corner : {boundary[i], next(boundary[i])}) {
        std::uint32_t& other = end_of_fan[fans_.find(corner)];
        if (other == kInvalid)
          other = i;
        else
          loops.unite(other, i);
      }
    for (std::uint32_t i = 0; i < boundary.size(); ++i)
      if (loops.find(i) == i) ++component(face_of_(boundary[i])).boundary_loops;
  }

  const IndexedFaceSet& mesh_;
  detail::FaceOfCorner face_of_;
  std::vector<std::uint8_t> degenerate_;
  std::vector<Edge> edges_;
  OrientedSets oriented_;
  detail::DisjointSets joined_;  ///< Faces that share an edge.
  detail::DisjointSets fans_;    ///< Corners of one point whose faces share an edge of two faces.
  SurfaceTopology result_;
};

}  // namespace

Result<SurfaceTopology> surface_topology(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<SurfaceTopology> {
    VKMESH_CHECK(detail::check_face_set(mesh.points.size(), mesh.corners, mesh.face_offsets));
    return Analysis(mesh).run();
  });
}

Result<ElementDefects> element_defects(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<ElementDefects> {
    VKMESH_CHECK(detail::check_face_set(mesh.points.size(), mesh.corners, mesh.face_offsets));
    ElementDefects defects;
    std::vector<bool> used(mesh.points.size(), false);
    for (const std::uint32_t c : mesh.corners) used[c] = true;
    defects.isolated_points = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      defects.degenerate_faces += detail::is_degenerate(mesh.face(f)) ? 1u : 0u;
    detail::DistinctRows<3> rows;
    std::vector<Vec3> distinct;
    for (const Vec3& p : mesh.points) static_cast<void>(rows.number(&p[0], distinct));
    defects.duplicate_points = mesh.points.size() - distinct.size();
    for (const detail::DuplicateFace& d : detail::duplicate_faces(mesh))
      defects.duplicate_faces += d.first != d.face ? 1u : 0u;
    return defects;
  });
}

}  // namespace vkmesh
