#include <algorithm>
#include <array>
#include <cmath>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/unit_frame.h>
#include <vkmesh/passes/collapse_costs.h>
#include <vkmesh/passes/detail/raw_measures.h>

#include "base/huge_pages.h"
#include "base/parallel.h"
#include "math/quadric.h"
#include "mesh/triangle_half_edges.h"
#include "passes/pass_input.h"
#include "passes/per_edge_values.h"
#include "simd/target_clones.h"

namespace vkmesh {
namespace {

Result<void> check(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                   const CollapseCostOptions& options) {
  VKMESH_CHECK(detail::require_triangles(mesh, "vertex_quadrics"));
  VKMESH_CHECK(detail::require_positions(positions, mesh.vertex_count()));
  return detail::require_collapse_cost_options(options);
}

using Device = detail::DeviceArithmetic;
using detail::Vector3;

// A plane through the origin, by its unit normal.
VertexQuadric plane(Vec3 n, float weight) {
  return detail::plane_quadric<Device>({n.x, n.y, n.z}, weight);
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

template <std::size_t kCount, class F>
std::array<float, kCount> each(std::array<float, kCount> v, F&& f) {
  for (float& x : v) x = f(x);
  return v;
}

// x · A x, from its vertex, which all its planes go through.
float value(const VertexQuadric& a, const Vector3& x) {
  const Vector3 from = each(x, Device::direction), ax = each(detail::times(a, from), Device::product);
  const float sum =
      Device::product(from[0] * ax[0]) + Device::product(from[1] * ax[1]) + Device::product(from[2] * ax[2]);
  return sum > 0.0f ? sum : 0.0f;
}

// Both quadrics at x, relative to p; q lies at d.
float both(const VertexQuadric& p, const VertexQuadric& q, const Vector3& d, const Vector3& x) {
  return value(p, x) + value(q, detail::minus(x, d));
}

// Where both quadrics together are least, relative to p: from the middle, which is where the sum keeps its
// digits.
Vector3 least_place(const VertexQuadric& p, const VertexQuadric& q, const Vector3& d) {
  const Vector3 middle = detail::times(0.5f, d);
  const VertexQuadric difference = each(detail::minus(p, q), Device::product);
  const Vector3 g = each(detail::times(difference, middle), Device::product);
  return detail::plus(middle, detail::way_to_least<Device>(detail::plus(p, q), g, d));
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
  [[nodiscard]] Vector3 along(std::size_t i) const { return {d[0][i], d[1][i], d[2][i]}; }
};

VKMESH_FLAT_CLONES void costs_at_least(const Edges& edges, std::size_t count, float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) {
    const VertexQuadric p = edges.quadric_p(i), q = edges.quadric_q(i);
    const Vector3 d = edges.along(i);
    out[i] = finite(both(p, q, d, least_place(p, q, d)));
  }
}
VKMESH_FLAT_CLONES void costs_in_middle(const Edges& edges, std::size_t count, float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 d = edges.along(i);
    out[i] = finite(both(edges.quadric_p(i), edges.quadric_q(i), d, detail::times(0.5f, d)));
  }
}
VKMESH_FLAT_CLONES void costs_at_end(const Edges& edges, std::size_t count, float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) {
    const VertexQuadric p = edges.quadric_p(i), q = edges.quadric_q(i);
    const Vector3 d = edges.along(i);
    const float at_p = both(p, q, d, {}), at_q = both(p, q, d, d);
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
  const detail::UnitFrame frame = detail::unit_frame_of(bounds_of(positions));
  options.centre = frame.centre;
  options.scale = std::clamp(frame.scale, 0x1p-60f, 0x1p60f);
  return options;
}

Result<std::vector<VertexQuadric>> vertex_quadrics(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
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
      const std::uint32_t p = corners[h], q = corners[detail::next_in_triangle(h)];
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
