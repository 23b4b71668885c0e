#include "optimize/swap_costs.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include <glm/geometric.hpp>

#include "base/huge_pages.h"
#include "base/parallel.h"
#include "math/angle.h"
#include "optimize/triangle_costs.h"

namespace vkmesh::detail {
namespace {

constexpr std::size_t kGrain = std::size_t{1} << 13;

// The numbers of three vertices and the squares of the sides between each and the next.
using Corners = std::array<std::uint32_t, 3>;
using Sides = std::array<double, 3>;

}  // namespace

SwapCosts::SwapCosts(SwapMesh& mesh, std::span<const DVec3> points, std::span<const WeightedSwapCost> costs,
                     std::span<const DVec3> normals)
    : mesh_(mesh), points_(points), normals_(normals) {
  for (const WeightedSwapCost& term : costs) weights_[static_cast<std::size_t>(term.cost)] += term.weight;
  using enum SwapCost;
  const auto any_of = [&](std::initializer_list<SwapCost> some) {
    return std::ranges::any_of(some, [&](SwapCost cost) { return weight(cost) > 0; });
  };
  const auto alone = [&](SwapCost cost) {
    return std::ranges::all_of(costs, [&](const WeightedSwapCost& term) { return term.cost == cost; });
  };
  worst_only_ = alone(kMinAngle) || alone(kAspectRatio);
  has_face_terms_ = any_of({kMinAngle, kAspectRatio, kDelaunay, kNormalDeviation});
  has_vertex_terms_ = any_of({kValence, kSquaredMeanCurvature, kAbsoluteCurvature});
  has_angles_ = any_of({kMeanCurvature, kSquaredMeanCurvature, kAbsoluteCurvature, kDihedralAngle});
  if (worst_only_) {
    weights_ = {};
    worst_cost_ = costs.front().cost;
    weights_[static_cast<std::size_t>(worst_cost_)] = 1;
  }
  // There are fewer terms than half-edges, and their sum stays below 2^62.
  unit_ = worst_only_ ? 0x1p32 : 0x1p24;
  most_ = worst_only_ ? unit_ : 0x1p61 / static_cast<double>(mesh.half_edge_bound() + 1);
  sum_up();
}

void SwapCosts::sum_up() {
  const std::size_t faces = mesh_.face_count();
  if (has_face_terms_) face_costs_ = large_vector<std::int64_t>(faces);
  if (has_angles_) {
    faces_.resize(faces);
    edges_.resize(4 * faces);
  }
  parallel_ranges(faces, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Corners& v = mesh_.face(static_cast<std::uint32_t>(4 * f)).origin;
      const Sides sides = {squared_length(v[0], v[1]), squared_length(v[1], v[2]),
                           squared_length(v[2], v[0])};
      if (has_face_terms_) face_costs_[f] = face_cost(v, sides);
      if (has_angles_) faces_[f] = shape_of(v, sides);
    }
  });
  if (has_angles_)
    parallel_ranges(faces, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t h = 4 * begin; h < 4 * end; ++h) {
        if (h % 4 == 3) continue;
        const auto of = static_cast<std::uint32_t>(h);
        const std::uint32_t t = mesh_.twin(of);
        if (!mesh_.is_ghost(t))
          edges_[h] = edge_between(faces_[h / 4].normal, faces_[t / 4].normal,
                                   squared_length(mesh_.origin(of), mesh_.origin(t)));
      }
    });
  if (!has_vertex_terms_) return;
  const std::size_t vertices = mesh_.apex();
  sums_.resize(vertices);
  vertex_costs_.resize(vertices);
  on_boundary_.resize(vertices);
  parallel_ranges(vertices, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const std::uint32_t first = mesh_.vertices[v].leading;
      if (first == kInvalid) continue;
      VertexSums& sums = sums_[v];
      std::uint32_t h = first;
      do {
        sums.valence += mesh_.target(h) != mesh_.apex() ? 1 : 0;
        if (mesh_.is_ghost(h)) {
          on_boundary_[v] = 1;
        } else if (has_angles_) {
          sums.area += faces_[h / 4].area;
          sums.angle += faces_[h / 4].angles[h % 4];
          sums.bend += edges_[h].bend;
        }
        h = mesh_.around_vertex(h);
      } while (h != first);
      vertex_costs_[v] = vertex_cost(static_cast<std::uint32_t>(v), sums);
    }
  });
}

double SwapCosts::squared_length(std::uint32_t p, std::uint32_t q) const {
  const DVec3 e = points_[q] - points_[p];
  return glm::dot(e, e);
}

std::int64_t SwapCosts::fixed(double cost) const {
  return fixed_point(cost, unit_, most_);
}

std::int64_t SwapCosts::face_cost(Corners v, Sides sides2) const {
  const SquaredSides sides(sides2[0], sides2[1], sides2[2]);
  using enum SwapCost;
  double cost = 0;
  if (weight(kMinAngle) > 0) cost += weight(kMinAngle) * (0.75 - std::min(0.75, sides.least_sine2()));
  if (weight(kAspectRatio) > 0) cost += weight(kAspectRatio) * (1 - std::min(1.0, sides.quality()));
  if (weight(kDelaunay) > 0) cost += weight(kDelaunay) * sides.cotangents();
  if (weight(kNormalDeviation) > 0) {
    const DVec3 normal = shape_of(v, sides2).normal;
    std::ranges::sort(v);  // the same sum whichever corner comes first
    double away = 0;
    for (const std::uint32_t corner : v) away += 1 - glm::dot(normal, normals_[corner]);
    cost += weight(kNormalDeviation) * sides.area() * (away / 3);
  }
  return fixed(cost);
}

SwapCosts::FaceShape SwapCosts::shape_of(Corners v, Sides sides2) const {
  FaceShape shape;
  // The smallest number first, so that the same face has the same bits whichever corner comes first.
  const std::size_t first = static_cast<std::size_t>(std::ranges::min_element(v) - v.begin());
  const DVec3 &a = points_[v[first]], &b = points_[v[(first + 1) % 3]], &c = points_[v[(first + 2) % 3]];
  shape.normal = unit_or_zero(glm::cross(b - a, c - a));
  if (!has_vertex_terms_) return shape;
  const double area = SquaredSides(sides2[0], sides2[1], sides2[2]).area();
  shape.area = fixed(area);
  if (!(weight(SwapCost::kAbsoluteCurvature) > 0)) return shape;
  for (std::size_t i = 0; i < 3; ++i) {
    const double product = 0.5 * (sides2[i] + sides2[(i + 2) % 3] - sides2[(i + 1) % 3]);
    shape.angles[i] = fixed(angle_of(2 * area, product));
  }
  return shape;
}

SwapCosts::EdgeShape SwapCosts::edge_between(const DVec3& left, const DVec3& right, double length2) const {
  const double angle = angle_between_normals(left, right);
  const double bend = std::sqrt(length2) * angle;
  return {fixed(weight(SwapCost::kMeanCurvature) * 0.5 * bend + weight(SwapCost::kDihedralAngle) * angle),
          has_vertex_terms_ ? fixed(bend) : 0};
}

std::int64_t SwapCosts::vertex_cost(std::uint32_t v, const VertexSums& sums) const {
  using enum SwapCost;
  double cost = 0;
  if (weight(kValence) > 0) {
    const auto excess = static_cast<double>(sums.valence - (on_boundary_[v] != 0 ? 4 : 6));
    cost += weight(kValence) * excess * excess;
  }
  if (has_angles_) {
    const double mean = static_cast<double>(sums.bend) / (4 * unit_);
    const double area = static_cast<double>(sums.area) / (3 * unit_);
    if (weight(kSquaredMeanCurvature) > 0 && sums.bend > 0)
      cost += weight(kSquaredMeanCurvature) * (mean * mean / area);
    if (weight(kAbsoluteCurvature) > 0) {
      const double gauss =
          (on_boundary_[v] != 0 ? 1 : 2) * std::numbers::pi - static_cast<double>(sums.angle) / unit_;
      const double square = gauss >= 0 ? mean * mean : mean * mean - area * gauss;
      cost += weight(kAbsoluteCurvature) * 2 * std::sqrt(square);
    }
  }
  return fixed(cost);
}

SwapCosts::FaceOutcome SwapCosts::faces_after(const SwapQuad& quad) const {
  const auto& [h, t, p, q, a, b] = quad;
  const double ab = squared_length(a, b);
  const std::int64_t of_p = face_cost({b, a, p}, {ab, squared_length(a, p), squared_length(p, b)}),
                     of_q = face_cost({a, b, q}, {ab, squared_length(b, q), squared_length(q, a)}),
                     of_f = face_costs_[h / 4], of_g = face_costs_[t / 4];
  return {{of_p, of_q},
          worst_only_ ? std::max(of_f, of_g) - std::max(of_p, of_q) : of_f + of_g - of_p - of_q};
}

SwapCosts::Outcome SwapCosts::outcome_of(const SwapQuad& quad) const {
  Outcome result;
  const auto& [h, t, p, q, a, b] = quad;
  const std::size_t f = h / 4, g = t / 4;
  const double ab = squared_length(a, b), qa = squared_length(q, a), ap = squared_length(a, p),
               pb = squared_length(p, b), bq = squared_length(b, q);
  const std::array<Corners, 2> corners = {{{b, a, p}, {a, b, q}}};
  const std::array<Sides, 2> sides = {{{ab, ap, pb}, {ab, bq, qa}}};
  if (has_face_terms_) {
    const FaceOutcome after = faces_after(quad);
    result.face_costs = after.costs;
    result.gain = after.gain;
  }
  std::array<std::int64_t, 5> bends{};  // what they were
  if (has_angles_) {
    for (std::size_t i = 0; i < 2; ++i) result.faces[i] = shape_of(corners[i], sides[i]);
    const std::array<std::uint32_t, 4> outer = quad.sides();
    const std::array<double, 4> lengths = {qa, ap, pb, bq};
    result.edges[4] = edge_between(result.faces[0].normal, result.faces[1].normal, ab);
    result.gain += edges_[h].cost - result.edges[4].cost;
    bends[4] = edges_[h].bend;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint32_t beyond = mesh_.twin(outer[i]);
      if (mesh_.is_ghost(beyond)) continue;
      const bool is_of_p = i == 1 || i == 2;
      result.edges[i] =
          edge_between(result.faces[is_of_p ? 0 : 1].normal, faces_[beyond / 4].normal, lengths[i]);
      result.gain += edges_[outer[i]].cost - result.edges[i].cost;
      bends[i] = edges_[outer[i]].bend;
    }
  }
  if (!has_vertex_terms_) return result;
  const std::array<std::uint32_t, 4> vertices = {p, q, a, b};
  for (std::size_t i = 0; i < 4; ++i) result.sums[i] = sums_[vertices[i]];
  auto& [at_p, at_q, at_a, at_b] = result.sums;
  --at_p.valence;
  --at_q.valence;
  ++at_a.valence;
  ++at_b.valence;
  if (has_angles_) {
    const auto more = [&](std::size_t edge) { return result.edges[edge].bend - bends[edge]; };
    constexpr std::size_t kNew = 4, kQa = 0, kAp = 1, kPb = 2, kBq = 3;
    at_p.bend += more(kAp) + more(kPb) - bends[kNew];
    at_q.bend += more(kQa) + more(kBq) - bends[kNew];
    at_a.bend += more(kQa) + more(kAp) + result.edges[kNew].bend;
    at_b.bend += more(kPb) + more(kBq) + result.edges[kNew].bend;
    const FaceShape &old_f = faces_[f], &old_g = faces_[g], &of_p = result.faces[0], &of_q = result.faces[1];
    at_p.area += of_p.area - old_f.area - old_g.area;
    at_q.area += of_q.area - old_f.area - old_g.area;
    at_a.area += of_p.area + of_q.area - old_f.area;
    at_b.area += of_p.area + of_q.area - old_g.area;
    const auto corner = [](std::uint32_t half_edge) { return half_edge % 4; };
    at_p.angle += of_p.angles[2] - old_f.angles[corner(h)] - old_g.angles[corner(SwapMesh::next(t))];
    at_q.angle += of_q.angles[2] - old_f.angles[corner(SwapMesh::next(h))] - old_g.angles[corner(t)];
    at_a.angle += of_p.angles[1] + of_q.angles[0] - old_f.angles[corner(SwapMesh::previous(h))];
    at_b.angle += of_p.angles[0] + of_q.angles[1] - old_g.angles[corner(SwapMesh::previous(t))];
  }
  for (std::size_t i = 0; i < 4; ++i) {
    result.vertex_costs[i] = vertex_cost(vertices[i], result.sums[i]);
    result.gain += vertex_costs_[vertices[i]] - result.vertex_costs[i];
  }
  return result;
}

std::int64_t SwapCosts::gain(std::uint32_t h) const {
  const SwapQuad quad(mesh_, h);
  return has_angles_ || has_vertex_terms_ ? outcome_of(quad).gain : faces_after(quad).gain;
}

void SwapCosts::swap(std::uint32_t h) {
  const SwapQuad quad(mesh_, h);
  const Outcome result = outcome_of(quad);
  mesh_.flip(h);
  const std::uint32_t t = quad.t;
  const std::array<std::uint32_t, 2> faces = {h / 4, t / 4};
  for (std::size_t i = 0; i < 2; ++i) {
    if (has_face_terms_) face_costs_[faces[i]] = result.face_costs[i];
    if (!has_angles_) continue;
    // Corner b is at h, or a at t, and the others follow.
    FaceShape& face = faces_[faces[i]];
    face = result.faces[i];
    std::uint32_t at = i == 0 ? h : t;
    for (std::size_t corner = 0; corner < 3; ++corner, at = SwapMesh::next(at))
      face.angles[at % 4] = result.faces[i].angles[corner];
  }
  if (has_angles_) {
    // Half-edges q → a, a → p, p → b and b → q now.
    const std::array<std::uint32_t, 5> now = {SwapMesh::previous(t), SwapMesh::next(h), SwapMesh::previous(h),
                                              SwapMesh::next(t), h};
    for (std::size_t i = 0; i < 5; ++i)
      for (const std::uint32_t e : {now[i], mesh_.twin(now[i])})
        if (!mesh_.is_ghost(e)) edges_[e] = result.edges[i];
  }
  if (!has_vertex_terms_) return;
  const std::array<std::uint32_t, 4> vertices = {quad.p, quad.q, quad.a, quad.b};
  for (std::size_t i = 0; i < 4; ++i) {
    sums_[vertices[i]] = result.sums[i];
    vertex_costs_[vertices[i]] = result.vertex_costs[i];
  }
}

double SwapCosts::total() const {
  std::int64_t sum = 0;
  for (const std::int64_t cost : face_costs_) sum += cost;
  for (std::uint32_t h = 0; h < edges_.size(); ++h)
    if (h % 4 != 3 && h < mesh_.twin(h)) sum += edges_[h].cost;
  for (const std::int64_t cost : vertex_costs_) sum += cost;
  return static_cast<double>(sum) / unit_;
}

}  // namespace vkmesh::detail
