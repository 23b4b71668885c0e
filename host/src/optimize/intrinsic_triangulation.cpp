#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/arithmetic.h>
#include <vkmesh/optimize/intrinsic_triangulation.h>

#include "math/angle.h"
#include "mesh/triangle_half_edges.h"
#include "optimize/triangle_costs.h"

namespace vkmesh {
namespace {

using detail::next_in_triangle;
using detail::previous_in_triangle;

double squared(double x) {
  return x * x;
}

/// Twice the area and the product of two sides and the cosine between them, for the corner between x and y.
struct Corner {
  double area, product;

  Corner(double x, double y, double opposite)
      : area(2 * detail::SquaredSides(squared(x), squared(y), squared(opposite)).area()),
        product(0.5 * (squared(x) + squared(y) - squared(opposite))) {}
  [[nodiscard]] double angle() const { return detail::angle_of(area, product); }
  [[nodiscard]] double cotangent() const { return product / area; }
};

}  // namespace

Result<IntrinsicTriangulation> IntrinsicTriangulation::create(const HalfEdgeMesh& mesh,
                                                              std::span<const Vec3> positions, double slack) {
  return detail::catching([&]() -> Result<IntrinsicTriangulation> {
    if (!mesh.is_triangles())
      return fail(ErrorCode::kUnsuitable,
                  "an intrinsic triangulation is made of triangles: triangulate first");
    if (positions.size() != mesh.vertex_count())
      return fail(ErrorCode::kUsage, "an intrinsic triangulation needs one position for each vertex");
    if (!(slack >= 0 && slack <= 1)) return fail(ErrorCode::kUsage, "the slack of triangles is from 0 to 1");
    VKMESH_CHECK(check_positions(positions));
    IntrinsicTriangulation result;
    result.origins_.assign(mesh.origins().begin(), mesh.origins().end());
    result.twins_.assign(mesh.twins().begin(), mesh.twins().end());
    const std::size_t half_edges = result.origins_.size();
    result.lengths_.resize(half_edges);
    double sum = 0;
    for (std::uint32_t h = 0; h < half_edges; ++h) {
      const DVec3 p(positions[result.origins_[h]]), q(positions[result.origins_[next_in_triangle(h)]]);
      result.lengths_[h] = glm::length(q - p);
      sum += result.lengths_[h];
    }
    const double least = half_edges == 0 ? 0 : slack * sum / static_cast<double>(half_edges);
    for (std::uint32_t h = 0; h < half_edges; ++h) {
      const auto& l = result.lengths_;
      result.added_length_ =
          std::max(result.added_length_, least + l[h] - l[next_in_triangle(h)] - l[previous_in_triangle(h)]);
    }
    for (double& length : result.lengths_) length += result.added_length_;

    result.angle_sums_.assign(mesh.vertex_count(), 0);
    result.directions_.assign(half_edges, 0);
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
      for (const HalfEdgeId h : mesh.half_edges_around(VertexId(v))) {
        result.directions_[h.index] = result.angle_sums_[v];
        result.angle_sums_[v] += result.corner_angle(h.index);
      }
    return result;
  });
}

double IntrinsicTriangulation::corner_angle(std::uint32_t h) const {
  return Corner(lengths_[h], lengths_[previous_in_triangle(h)], lengths_[next_in_triangle(h)]).angle();
}

double IntrinsicTriangulation::cotangent_sum(std::uint32_t h) const {
  const auto across = [&](std::uint32_t e) {
    return Corner(lengths_[next_in_triangle(e)], lengths_[previous_in_triangle(e)], lengths_[e]).cotangent();
  };
  return across(h) + across(twins_[h]);
}

bool IntrinsicTriangulation::can_flip(std::uint32_t h) const {
  const std::uint32_t t = twins_[h];
  if (t == kInvalid || h / 3 == t / 3) return false;
  // Convex at both ends: the two angles there come to less than π.
  const auto is_convex = [&](std::uint32_t left, std::uint32_t right) {
    const Corner a(lengths_[left], lengths_[previous_in_triangle(left)], lengths_[next_in_triangle(left)]),
        b(lengths_[right], lengths_[previous_in_triangle(right)], lengths_[next_in_triangle(right)]);
    return a.area * b.product + a.product * b.area > 0;  // the sine of the sum
  };
  return is_convex(h, next_in_triangle(t)) && is_convex(t, next_in_triangle(h));
}

void IntrinsicTriangulation::flip(std::uint32_t h) {
  const std::uint32_t t = twins_[h], nh = next_in_triangle(h), ph = previous_in_triangle(h),
                      nt = next_in_triangle(t), pt = previous_in_triangle(t);
  const std::uint32_t p = origins_[h], q = origins_[t], a = origins_[ph], b = origins_[pt];
  const double pq = lengths_[h], qa = lengths_[nh], ap = lengths_[ph], pb = lengths_[nt], bq = lengths_[pt];
  // Unfolded: p at 0, q on the axis, a above it and b below.
  const Corner at_a(pq, ap, qa), at_b(pq, pb, bq);
  const double ab =
      std::sqrt(squared((at_a.product - at_b.product) / pq) + squared((at_a.area + at_b.area) / pq));
  const std::array<std::uint32_t, 4> beyond = {twins_[nh], twins_[ph], twins_[nt],
                                               twins_[pt]};  // qa, ap, pb, bq
  const double from_q = directions_[nh], from_a = directions_[ph], from_p = directions_[nt],
               from_b = directions_[pt];
  // Two sides may be one edge, both of whose half-edges move.
  const auto moved = [&](std::uint32_t e) {
    return e == nh ? pt : e == ph ? nh : e == nt ? ph : e == pt ? nt : e;
  };
  const auto set = [&](std::uint32_t e, std::uint32_t origin, std::uint32_t old_twin, double length,
                       double direction) {
    const std::uint32_t twin = moved(old_twin);
    origins_[e] = origin;
    twins_[e] = twin;
    if (twin != kInvalid) twins_[twin] = e;
    lengths_[e] = length;
    directions_[e] = direction;
  };
  // Faces b, a, p and a, b, q, as EditMesh::flip() leaves them.
  set(nh, a, beyond[1], ap, from_a);
  set(ph, p, beyond[2], pb, from_p);
  set(nt, b, beyond[3], bq, from_b);
  set(pt, q, beyond[0], qa, from_q);
  set(h, b, t, ab, 0);
  set(t, a, h, ab, 0);
  // Counter-clockwise of the side that leaves the same vertex, by the angle between.
  const auto turned = [&](std::uint32_t side) {
    const double direction = directions_[side] + corner_angle(side), sum = angle_sums_[origins_[side]];
    return direction < sum ? direction : direction - sum;
  };
  directions_[h] = turned(nt);
  directions_[t] = turned(nh);
}

Result<IntrinsicTriangulation::Flips> IntrinsicTriangulation::flip_to_delaunay(const Progress& progress) {
  return detail::catching([&]() -> Result<Flips> {
    constexpr double kLeast = 1e-9;
    constexpr std::size_t kBetweenReports = 1 << 16;
    Flips result;
    // Edges by the smaller of their half-edges; the queue is a ring of what is to be looked at.
    std::vector<std::uint32_t> queue;
    std::vector<bool> waits(half_edge_count(), false);
    const auto add = [&](std::uint32_t h) {
      if (twins_[h] == kInvalid) return;
      const std::uint32_t e = std::min(h, twins_[h]);
      if (waits[e]) return;
      waits[e] = true;
      queue.push_back(e);
    };
    for (std::uint32_t h = 0; h < half_edge_count(); ++h) add(h);
    const std::size_t most = 100 * std::max<std::size_t>(queue.size(), 1), first = queue.size();
    std::vector<std::uint32_t> round;
    for (std::size_t looked = 0; !queue.empty();) {
      round.swap(queue);
      queue.clear();
      for (const std::uint32_t e : round) {
        if (progress && looked++ % kBetweenReports == 0 &&
            !progress(
                std::min(1.0, static_cast<double>(looked) / static_cast<double>(first + 5 * result.flips))))
          return fail(ErrorCode::kInterrupted, "cancelled");
        if (!waits[e]) continue;
        waits[e] = false;
        if (twins_[e] == kInvalid || !(cotangent_sum(e) < -kLeast) || !can_flip(e)) continue;
        if (result.flips == most) return Flips{result.flips, false};
        // The sides move to other half-edges: what waited by an old number waits by the new one.
        for (const std::uint32_t side : {next_in_triangle(e), previous_in_triangle(e),
                                         next_in_triangle(twins_[e]), previous_in_triangle(twins_[e])})
          if (twins_[side] != kInvalid) waits[std::min(side, twins_[side])] = false;
        flip(e);
        ++result.flips;
        for (const std::uint32_t side : {next_in_triangle(e), previous_in_triangle(e),
                                         next_in_triangle(twins_[e]), previous_in_triangle(twins_[e])})
          add(side);
      }
    }
    return result;
  });
}

}  // namespace vkmesh
