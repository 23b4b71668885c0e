// What swaps would gain, and what the surface costs: whole numbers, kept up as swaps are done.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/math/vec.h>
#include <vkmesh/optimize/swap_edges.h>

#include "optimize/swap_block.h"
#include "optimize/swap_mesh.h"

namespace vkmesh::detail {

/// The cost of a surface is a sum of terms of its faces, edges and vertices. Each is a whole number that the
/// surface as it is determines, not the swaps that led to it; those of a vertex are made of sums of whole
/// numbers, which swaps change without rounding.
class SwapCosts {
 public:
  /// `points`: lengths of about 1. `normals`: of each vertex, unit or zero, for SwapCost::kNormalDeviation.
  /// All must outlive this. O(n).
  SwapCosts(SwapMesh& mesh, std::span<const DVec3> points, std::span<const WeightedSwapCost> costs,
            std::span<const DVec3> normals);

  /// By how much the swap of an inner edge lowers the cost; with kMinAngle or kAspectRatio alone how
  /// much better the worse of its triangles gets. O(1).
  [[nodiscard]] std::int64_t gain(std::uint32_t h) const;
  /// Calls f(half-edge, gain) for the inner edges of these faces whose swap gains, each by the smaller of its
  /// half-edges, in ascending order. O(faces).
  template <class F>
  void for_each_gain(std::size_t first_face, std::size_t last_face, F&& f) const {
    const auto add = [&](std::uint32_t h) {
      if (const std::int64_t g = gain(h); g > 0) f(h, g);
    };
    SwapBlock block;
    for (auto h = static_cast<std::uint32_t>(4 * first_face); h < 4 * last_face; ++h) {
      if (h % 4 == 3 || h > mesh_.twin(h) || mesh_.is_ghost(mesh_.twin(h))) continue;
      if (!worst_only_) {
        add(h);
        continue;
      }
      block.add(points_, SwapQuad(mesh_, h));
      if (block.is_full()) block.for_each_promising(worst_cost_, add);
    }
    block.for_each_promising(worst_cost_, add);
  }
  /// Flips the edge. O(1).
  void swap(std::uint32_t h);
  /// Calls f(half-edge), once or more often, for inner edges that are all those whose gain the swap of h has
  /// changed, its own among them. O(1), with terms of vertices O(valences).
  template <class F>
  void for_each_changed(std::uint32_t h, F&& f) const {
    const SwapQuad quad(mesh_, h);
    const auto inner = [&](std::uint32_t e) {
      if (!mesh_.is_ghost(e) && !mesh_.is_ghost(mesh_.twin(e))) f(e);
    };
    if (has_vertex_terms_) {
      for (const std::uint32_t v : {quad.p, quad.q, quad.a, quad.b}) for_each_edge_of_ring(v, inner);
      return;
    }
    f(h);
    for (const std::uint32_t side : quad.sides()) {
      inner(side);
      if (!has_angles_) continue;
      const std::uint32_t beyond = mesh_.twin(side);
      if (mesh_.is_ghost(beyond)) continue;
      inner(SwapMesh::next(beyond));
      inner(SwapMesh::previous(beyond));
    }
  }
  /// The cost of the whole surface. O(n).
  [[nodiscard]] double total() const;

 private:
  /// The normal, the area and the angles of a face, for the terms of edges and vertices.
  struct FaceShape {
    DVec3 normal{0.0};  // zero where there is no area
    std::int64_t area = 0;
    std::array<std::int64_t, 3> angles{};
  };
  struct EdgeShape {
    std::int64_t cost = 0, bend = 0;  // |e||β|
  };
  struct VertexSums {
    std::int64_t bend = 0, area = 0, angle = 0, valence = 0;
  };
  /// What the two faces, five edges and four vertices of a quadrilateral are after the swap: faces (b, a, p)
  /// and (a, b, q), edges ab, qa, ap, pb, bq, vertices p, q, a, b.
  struct Outcome {
    std::array<std::int64_t, 2> face_costs;
    std::array<FaceShape, 2> faces;
    std::array<EdgeShape, 5> edges;
    std::array<VertexSums, 4> sums;
    std::array<std::int64_t, 4> vertex_costs;
    std::int64_t gain = 0;
  };

  template <class F>
  void for_each_edge_of_ring(std::uint32_t v, F&& f) const {
    const std::uint32_t first = mesh_.vertices[v].leading;
    std::uint32_t h = first;
    do {
      f(h);
      if (!mesh_.is_ghost(h)) f(SwapMesh::next(h));
      h = mesh_.around_vertex(h);
    } while (h != first);
  }

  [[nodiscard]] double weight(SwapCost cost) const { return weights_[static_cast<std::size_t>(cost)]; }
  [[nodiscard]] double squared_length(std::uint32_t p, std::uint32_t q) const;
  /// A cost of at least 0 as a whole number.
  [[nodiscard]] std::int64_t fixed(double cost) const;
  [[nodiscard]] std::int64_t face_cost(std::array<std::uint32_t, 3> v, std::array<double, 3> sides2) const;
  [[nodiscard]] FaceShape shape_of(std::array<std::uint32_t, 3> v, std::array<double, 3> sides2) const;
  /// An edge between faces of these normals, of this squared length.
  [[nodiscard]] EdgeShape edge_between(const DVec3& left, const DVec3& right, double length2) const;
  [[nodiscard]] std::int64_t vertex_cost(std::uint32_t v, const VertexSums& sums) const;
  /// The costs of the faces (b, a, p) and (a, b, q), and what terms of faces gain.
  struct FaceOutcome {
    std::array<std::int64_t, 2> costs;
    std::int64_t gain;
  };
  [[nodiscard]] FaceOutcome faces_after(const SwapQuad& quad) const;
  [[nodiscard]] Outcome outcome_of(const SwapQuad& quad) const;
  void sum_up();

  SwapMesh& mesh_;
  std::span<const DVec3> points_, normals_;
  std::array<double, kSwapCosts> weights_{};
  SwapCost worst_cost_ = SwapCost::kMinAngle;  // with worst_only_
  bool worst_only_ = false, has_face_terms_ = false, has_angles_ = false, has_vertex_terms_ = false;
  double unit_ = 0, most_ = 0;
  // By face; by half-edge, both of an edge; by vertex. Empty where no term needs them.
  std::vector<std::int64_t> face_costs_;
  std::vector<FaceShape> faces_;
  std::vector<EdgeShape> edges_;
  std::vector<VertexSums> sums_;
  std::vector<std::int64_t> vertex_costs_;
  std::vector<std::uint8_t> on_boundary_;
};

}  // namespace vkmesh::detail
