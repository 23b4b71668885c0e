#include <algorithm>
#include <cmath>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/passes/collapse_costs.h>
#include <vkmesh/passes/detail/raw_measures.h>

#include "base/huge_pages.h"
#include "base/parallel.h"
#include "passes/pass_input.h"
#include "passes/per_edge_values.h"
#include "simd/target_clones.h"

namespace vkmesh {
namespace {

Result<void> check(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                   const CollapseCostOptions& options) {
  VKMESH_CHECK(detail::require_triangles(mesh, "quadrics"));
  VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
  return detail::require_collapse_cost_options(options);
}

// Products below this count as zero, so that none is subnormal.
float seen(float x) {
  return zero_below(x, VKMESH_TINY_COORDINATE);
}

// A plane through the origin, by its unit normal.
VertexQuadric plane(Vec3 n, float weight) {
  const Vec3 w = zero_below(weight * n, VKMESH_TINY_QUADRIC);
  const auto entry = [](float x) { return zero_below(x, VKMESH_TINY_QUADRIC); };
  return {entry(w.x * n.x), entry(w.x * n.y), entry(w.x * n.z),
          entry(w.y * n.y), entry(w.y * n.z), entry(w.z * n.z)};
}

// The plane that stands on the edge from p to q, perpendicular to the face of normal n.
VertexQuadric boundary_plane(Vec3 p, Vec3 q, Vec3 n, float boundary_weight) {
  const Vec3 e = zero_below(q - p, VKMESH_TINY_DIRECTION);
  const Vec3 across =
      zero_below(Vec3(e.y * n.z - e.z * n.y, e.z * n.x - e.x * n.z, e.x * n.y - e.y * n.x), VKMESH_TINY_AREA);
  return plane(unit_vector(across), boundary_weight * squared_length(e));
}

void add(VertexQuadric& sum, const VertexQuadric& more) {
  for (std::size_t k = 0; k < 6; ++k) sum[k] += more[k];
}

Vec3 times(const VertexQuadric& a, Vec3 x) {
  return {(a[0] * x.x + a[1] * x.y) + a[2] * x.z, (a[1] * x.x + a[3] * x.y) + a[4] * x.z,
          (a[2] * x.x + a[4] * x.y) + a[5] * x.z};
}

// x · A x, from its vertex.
float value(const VertexQuadric& a, Vec3 x) {
  const Vec3 from = zero_below(x, VKMESH_TINY_DIRECTION);
  const Vec3 ax = zero_below(times(a, from), VKMESH_TINY_COORDINATE);
  const float sum = (seen(from.x * ax.x) + seen(from.y * ax.y)) + seen(from.z * ax.z);
  return sum > 0.0f ? sum : 0.0f;
}

// Both quadrics at x, relative to p; q lies at d.
float both(const VertexQuadric& p, const VertexQuadric& q, Vec3 d, Vec3 x) {
  return value(p, x) + value(q, x - d);
}

// L D Lᵀ of A + εI, by which A s = −g is solved.
struct Factors {
  float r0, r1, r2, l1, l2, l3;

  explicit Factors(const VertexQuadric& a) {
    // Directions in which the quadric is flatter than this share of its steepest are left alone; pivots are
    // at least that share but for rounding.
    const float e = ((a[0] + a[3]) + a[5]) * VKMESH_FLAT_SHARE + VKMESH_FLAT_LEAST, least = 0.5f * e;
    r0 = reciprocal(a[0] + e);
    l1 = seen(a[1] * r0);
    l2 = seen(a[2] * r0);
    const float p1 = (a[3] + e) - seen(l1 * a[1]);
    r1 = reciprocal(p1 > least ? p1 : least);
    const float u = seen(a[4] - seen(l2 * a[1]));
    l3 = seen(u * r1);
    const float p2 = ((a[5] + e) - seen(l2 * a[2])) - seen(l3 * u);
    r2 = reciprocal(p2 > least ? p2 : least);
  }

  [[nodiscard]] Vec3 solve(Vec3 g) const {
    const float w0 = -g.x, w1 = seen(-g.y - seen(l1 * w0)), w2 = seen((-g.z - seen(l2 * w0)) - seen(l3 * w1));
    const float z = seen(w2 * r2);
    const float y = seen(seen(w1 * r1) - seen(l3 * z));
    const float x = seen((seen(w0 * r0) - seen(l1 * y)) - seen(l2 * z));
    return {x, y, z};
  }
};

// Where both quadrics together are least, relative to p: from the middle, which is where the sum keeps its
// digits.
Vec3 least_place(const VertexQuadric& p, const VertexQuadric& q, Vec3 d) {
  const Vec3 m = 0.5f * d;
  VertexQuadric sum, difference;
  for (std::size_t k = 0; k < 6; ++k) {
    sum[k] = p[k] + q[k];
    difference[k] = seen(p[k] - q[k]);
  }
  const Vec3 g = zero_below(times(difference, m), VKMESH_TINY_COORDINATE);
  const Factors factors(sum);
  const Vec3 first = factors.solve(g);
  // Once more for the rest, which takes back what ε has shortened of steep directions.
  const Vec3 rest =
      zero_below(g + times(sum, zero_below(first, VKMESH_TINY_DIRECTION)), VKMESH_TINY_COORDINATE);
  const Vec3 s = zero_below(first + factors.solve(rest), VKMESH_TINY_DIRECTION);
  // Farther from the middle than twice the edge no planes of its faces can lead in earnest.
  const bool near = squared_length(s) <= 4.0f * squared_length(d);
  return near ? m + s : m;
}

float finite(float cost) {
  return (detail::bits(cost) & 0x7fffffffu) < 0x7f800000u ? cost : VKMESH_LARGEST;
}

// Quadrics word by word, as vector registers take them.
struct Edges {
  using Lanes = std::array<float, detail::kEdgeBlock>;
  std::array<Lanes, 6> p, q;
  std::array<Lanes, 3> d;

  [[nodiscard]] VertexQuadric quadric_p(std::size_t i) const {
    return {p[0][i], p[1][i], p[2][i], p[3][i], p[4][i], p[5][i]};
  }
  [[nodiscard]] VertexQuadric quadric_q(std::size_t i) const {
    return {q[0][i], q[1][i], q[2][i], q[3][i], q[4][i], q[5][i]};
  }
  [[nodiscard]] Vec3 along(std::size_t i) const { return {d[0][i], d[1][i], d[2][i]}; }
};

VKMESH_FLAT_CLONES void costs_at_least(const Edges& edges, std::size_t count, float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) {
    const VertexQuadric p = edges.quadric_p(i), q = edges.quadric_q(i);
    const Vec3 d = edges.along(i);
    out[i] = finite(both(p, q, d, least_place(p, q, d)));
  }
}
VKMESH_FLAT_CLONES void costs_in_middle(const Edges& edges, std::size_t count, float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 d = edges.along(i);
    out[i] = finite(both(edges.quadric_p(i), edges.quadric_q(i), d, 0.5f * d));
  }
}
VKMESH_FLAT_CLONES void costs_at_end(const Edges& edges, std::size_t count, float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) {
    const VertexQuadric p = edges.quadric_p(i), q = edges.quadric_q(i);
    const Vec3 d = edges.along(i);
    const float at_p = both(p, q, d, Vec3(0.0f)), at_q = both(p, q, d, d);
    out[i] = finite(at_q <= at_p ? at_q : at_p);
  }
}

// Triangles by their area vectors: unit normals, and what their planes add to a quadric.
struct Planes {
  std::vector<Vec3> normals;
  std::vector<VertexQuadric> quadrics;
};
VKMESH_FLAT_CLONES void make_planes(std::size_t count, Vec3* __restrict normals,
                                    VertexQuadric* __restrict out) {
  for (std::size_t f = 0; f < count; ++f) {
    const Vec3 area = normals[f], n = unit_vector(area);
    out[f] = plane(n, 0.5f * vector_length(area));
    normals[f] = n;
  }
}

}  // namespace

Result<void> detail::require_collapse_cost_options(const CollapseCostOptions& options) {
  if (!(options.scale >= 0x1p-60f && options.scale <= 0x1p60f))
    return fail(ErrorCode::kUsage, "the scale of collapse costs must lie in [2^-60, 2^60]");
  if (!(options.boundary_weight >= 0.0f && options.boundary_weight <= 0x1p20f))
    return fail(ErrorCode::kUsage, "boundary_weight must lie in [0, 2^20]");
  for (int k = 0; k < 3; ++k)
    if (!(std::fabs(options.centre[k]) < kMaxCoordinate))
      return fail(ErrorCode::kUsage, "the centre of collapse costs must be finite and below 2^60");
  return {};
}

CollapseCostOptions unit_frame(std::span<const Vec3> positions) {
  CollapseCostOptions options;
  if (positions.empty()) return options;
  Vec3 low = positions[0], high = low;
  for (const Vec3& p : positions)
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  const detail::MeasuresFrame frame = detail::frame_of_bounds(low, high);
  options.centre = frame.centre;
  options.scale = std::clamp(frame.scale, 0x1p-60f, 0x1p60f);
  return options;
}

Result<std::vector<VertexQuadric>> quadrics(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                            const CollapseCostOptions& options) {
  return detail::catching([&]() -> Result<std::vector<VertexQuadric>> {
    VKMESH_CHECK(check(mesh, positions, options));
    const auto corners = mesh.origins(), twins = mesh.twins();
    const auto scaled = [&](std::size_t h) {
      return zero_below((positions[corners[h]] - options.centre) * options.scale, VKMESH_TINY_DIRECTION);
    };
    std::vector<VertexQuadric> result = detail::large_vector<VertexQuadric>(positions.size());
    // The planes of a block of faces on any core, then their sums in the order in which the shader gathers.
    const auto make = [&](std::size_t begin, std::size_t end, Planes& block) {
      block.normals.resize(end - begin);
      block.quadrics.resize(end - begin);
      for (std::size_t f = begin; f < end; ++f)
        block.normals[f - begin] = area_vector(scaled(3 * f), scaled(3 * f + 1), scaled(3 * f + 2));
      make_planes(end - begin, block.normals.data(), block.quadrics.data());
    };
    const auto add_up = [&](std::size_t begin, std::size_t end, const Planes& block) {
      for (std::size_t f = begin; f < end; ++f)
        for (std::size_t i = 0; i < 3; ++i) {
          const std::size_t h = 3 * f + i, next = 3 * f + (i + 1) % 3, previous = 3 * f + (i + 2) % 3;
          const auto boundary = [&](std::size_t from, std::size_t to) {
            return boundary_plane(scaled(from), scaled(to), block.normals[f - begin],
                                  options.boundary_weight);
          };
          VertexQuadric& sum = result[corners[h]];
          add(sum, block.quadrics[f - begin]);
          if (twins[h] == kInvalid) add(sum, boundary(h, next));
          if (twins[previous] == kInvalid) add(sum, boundary(previous, h));
        }
    };
    detail::parallel_in_order<Planes>(mesh.face_count(), 1 << 11, make, add_up);
    return result;
  });
}

Result<std::vector<float>> collapse_costs(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                          std::span<const VertexQuadric> quadrics,
                                          const CollapseCostOptions& options) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    VKMESH_CHECK(check(mesh, positions, options));
    if (quadrics.size() != mesh.vertex_count())
      return fail(ErrorCode::kUsage, "collapse costs need one quadric for each vertex");
    const auto corners = mesh.origins();
    const auto scaled = [&](std::uint32_t v) {
      return zero_below((positions[v] - options.centre) * options.scale, VKMESH_TINY_DIRECTION);
    };
    const auto take = [&](Edges& block, std::size_t i, std::uint32_t h) {
      const std::uint32_t p = corners[h], q = corners[h % 3 == 2 ? h - 2 : h + 1];
      const Vec3 d = zero_below(scaled(q) - scaled(p), VKMESH_TINY_DIRECTION);
      for (std::size_t k = 0; k < 6; ++k) {
        block.p[k][i] = quadrics[p][k];
        block.q[k][i] = quadrics[q][k];
      }
      block.d[0][i] = d.x, block.d[1][i] = d.y, block.d[2][i] = d.z;
    };
    const auto compute = [&](const Edges& block, std::size_t count, std::span<float> out) {
      const auto costs = options.placement == CollapsePlacement::kOptimal    ? costs_at_least
                         : options.placement == CollapsePlacement::kMidpoint ? costs_in_middle
                                                                             : costs_at_end;
      costs(block, count, out.data());
    };
    return detail::edge_values<Edges>(mesh, true, 0.0f, take, compute);
  });
}

}  // namespace vkmesh
