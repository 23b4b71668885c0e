#include "decimation/cost/attribute_quadrics.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace vkmesh::detail {
namespace {

/// Attributes have no gradient on a triangle of less area than this share of its squared sides.
constexpr double kDegenerate = 1e-6;

/// What parts two functions of weights w and v counts so much when they become one.
float harmonic(float w, float v) {
  return w + v > 0 ? w * v / (w + v) : 0.0f;
}

/// The first's share.
float share(float w, float v) {
  return w + v > 0 ? w / (w + v) : 0.0f;
}

/// An end of an edge of a batch.
void lock(EdgeBatch::Words& end, std::size_t lane) {
  float& flags = end[VertexRecord::kSource][lane];
  flags = std::bit_cast<float>(std::bit_cast<std::uint32_t>(flags) | VertexRecord::kLocked);
}

}  // namespace

AttributeQuadrics::AttributeQuadrics(CollapseMesh& mesh, std::size_t vertex_count, Wedges wedges,
                                     std::span<const DecimateAttribute> attributes,
                                     std::span<const std::uint32_t> corners, double diagonal, bool apart,
                                     Stop& stop)
    : mesh_(mesh), wedges_(std::move(wedges)), attributes_(attributes), corners_(corners) {
  for (std::size_t a = 0; a < attributes.size(); ++a) {
    const DecimateAttribute& attribute = attributes[a];
    const double unit = attribute.weight * diagonal;
    double range = 0;
    const std::size_t first = components_.size();
    for (std::size_t k = 0; k < attribute.components; ++k) {
      float low = std::numeric_limits<float>::infinity(), high = -low;
      for (std::size_t i = k; i < attribute.values.size(); i += attribute.components) {
        low = std::min(low, attribute.values[i]);
        high = std::max(high, attribute.values[i]);
      }
      const double middle = 0.5 * static_cast<double>(low) + 0.5 * static_cast<double>(high);
      range = std::max(range, static_cast<double>(high) - static_cast<double>(low));
      components_.push_back({a, k, middle, 1.0, static_cast<float>(unit * unit), low, high});
    }
    if (attribute.kind == AttributeKind::kNormal) range = 1;
    for (std::size_t c = first; c < components_.size(); ++c) components_[c].range = range > 0 ? range : 1;
  }

  const std::size_t n = components_.size();
  weight_.assign(wedges_.count(), 0.0f);
  function_.resize(n * wedges_.count());
  value_.resize(function_.size());
  for (std::uint32_t w = 0; w < wedges_.count(); ++w)
    for (std::size_t k = 0; k < n; ++k) {
      const Component& c = components_[k];
      const double value = value_of(c.attribute, wedges_.source_corner(w), c.index);
      const auto local = static_cast<float>((value - c.middle) / c.range);
      value_[w * n + k] = local;
      function_[w * n + k] = {{0.0f, 0.0f, 0.0f}, local};
    }
  if (apart) {
    apart_.resize(vertex_count);
  } else {
    plain_.resize(vertex_count);
    for (std::size_t v = 0; v < vertex_count; ++v) plain_[v] = mesh.vertices[v].quadric;
    deviation_.assign(vertex_count, 0.0f);
  }
  constexpr std::uint32_t kBetween = 1 << 13;  // faces from one question to the next
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (f % kBetween == 0 && !goes_on(&stop)) return;
    add_face(f);
  }
}

void AttributeQuadrics::keep_changes() {
  keeps_changes_ = true;
  changes_.values.resize(attributes_.size());
  changes_.corners.resize(3 * mesh_.face_count());
  for (std::uint32_t f = 0; f < mesh_.face_count(); ++f)
    for (std::uint32_t h = 4 * f; h < 4 * f + 3; ++h)
      changes_.corners[Wedges::source_corner(mesh_, h)] = wedges_.source_corner(wedges_[h]);
}

void AttributeQuadrics::keep_change(std::uint32_t h, bool moved) {
  std::array<std::uint32_t, 2> joined{kInvalid, kInvalid};
  std::size_t count = 0;
  const auto add = [&](std::uint32_t wedge, std::uint32_t into) {
    changes_.wedges.push_back({step_, wedges_.source_corner(wedge), wedges_.source_corner(into)});
    append_values(into, moved, changes_.values);
  };
  wedges_.for_each_pair(mesh_, h, [&](std::uint32_t from, std::uint32_t to) {
    add(from, to);
    joined[count++] = to;
  });
  if (moved)
    wedges_.for_each_at(mesh_, mesh_.target(h), [&](std::uint32_t w) {
      if (w != joined[0] && w != joined[1]) add(w, w);
    });
  ++step_;
}

double AttributeQuadrics::value_of(std::size_t attribute, std::uint32_t corner, std::size_t component) const {
  const DecimateAttribute& a = attributes_[attribute];
  const std::size_t value = a.corners.empty() ? corners_[corner] : a.corners[corner];
  return static_cast<double>(a.values[value * a.components + component]);
}

void AttributeQuadrics::add_face(std::uint32_t f) {
  const std::size_t n = components_.size();
  const auto& origin = mesh_.face(4 * f).origin;
  using Vector = std::array<double, 3>;
  const auto side = [&](std::size_t from, std::size_t to) {
    Vector d;
    for (std::size_t k = 0; k < 3; ++k)
      d[k] = static_cast<double>(mesh_.vertices[origin[to]].position[k]) -
             static_cast<double>(mesh_.vertices[origin[from]].position[k]);
    return d;
  };
  const auto cross = [](const Vector& a, const Vector& b) {
    return Vector{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto square = [](const Vector& a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; };
  const Vector ab = side(0, 1), ca = side(2, 0), normal = cross(side(1, 2), ca);
  const double twice = std::sqrt(square(normal));
  if (!(twice > kDegenerate * (square(ab) + square(ca)))) return;
  // Gradients of the functions that are 1 at b, or at c, and 0 at the other corners.
  Vector of_b = cross(normal, ca), of_c = cross(normal, ab);
  for (std::size_t k = 0; k < 3; ++k) {
    of_b[k] /= twice * twice;
    of_c[k] /= twice * twice;
  }
  const auto area = static_cast<float>(0.5 * twice);
  const std::array<std::uint32_t, 3> wedge = {wedges_[4 * f], wedges_[4 * f + 1], wedges_[4 * f + 2]};
  for (std::size_t k = 0; k < n; ++k) {
    const auto value = [&](std::size_t i) { return static_cast<double>(value_[wedge[i] * n + k]); };
    const double b = value(1) - value(0), c = value(2) - value(0);
    Vector3 gradient;
    for (std::size_t i = 0; i < 3; ++i) gradient[i] = static_cast<float>(b * of_b[i] + c * of_c[i]);
    for (std::size_t i = 0; i < 3; ++i) {
      // All functions of a wedge have the same value at its vertex: only gradients differ.
      auto& mean = function_[wedge[i] * n + k].gradient;
      const float weight = weight_[wedge[i]], part = share(area, weight);
      Vector3 difference;
      for (std::size_t j = 0; j < 3; ++j) {
        difference[j] = gradient[j] - mean[j];
        mean[j] += part * difference[j];
      }
      Quadric& quadric = apart_.empty() ? mesh_.vertices[origin[i]].quadric : apart_[origin[i]];
      quadric.add_square(difference, 0, components_[k].cost * harmonic(area, weight));
    }
  }
  for (const std::uint32_t w : wedge) weight_[w] += area;
}

Vector3 AttributeQuadrics::between(std::uint32_t p, std::uint32_t q) const {
  return minus(mesh_.vertices[q].position, mesh_.vertices[p].position);
}

void AttributeQuadrics::add_difference(std::uint32_t wedge_p, std::uint32_t wedge_q, float weight_q,
                                       const Vector3& d, Quadric& to) const {
  const std::size_t n = components_.size();
  const float weight = harmonic(weight_[wedge_p], weight_q);
  for (std::size_t k = 0; k < n; ++k) {
    const Function &p = function_[wedge_p * n + k], &q = function_[wedge_q * n + k];
    to.add_square(minus(p.gradient, q.gradient), p.value - (q.value - dot(q.gradient, d)),
                  weight * components_[k].cost);
  }
}

float AttributeQuadrics::deviation(std::uint32_t wedge, const Vector3& x, std::uint32_t at) const {
  const std::size_t n = components_.size();
  float sum = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const Function& f = function_[wedge * n + k];
    const float off = f.value + dot(f.gradient, x) - value_[at * n + k];
    sum += components_[k].cost * off * off;
  }
  return weight_[wedge] * sum;
}

float AttributeQuadrics::deviation(std::uint32_t v) const {
  float sum = 0;
  wedges_.for_each_at(mesh_, v, [&](std::uint32_t w) { sum += deviation(w, {0.0f, 0.0f, 0.0f}, w); });
  return sum;
}

void AttributeQuadrics::add_to(EdgeBatch& batch, std::span<const std::uint32_t> edges) const {
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const std::uint32_t h = edges[i], p = mesh_.origin(h), q = mesh_.target(h);
    const Vector3 d = between(p, q);
    const auto stays = [&](std::uint32_t v) { return mesh_.vertices[v].has(VertexRecord::kLocked); };
    const bool p_stays = stays(p), q_stays = stays(q);
    if (wedges_.on_seam(p) && !wedges_.on_seam(q) && q_stays) lock(batch.p, i);
    if (wedges_.on_seam(q) && !wedges_.on_seam(p) && p_stays) lock(batch.q, i);
    if (!p_stays && !q_stays) {
      Quadric more;
      wedges_.for_each_pair(mesh_, h, [&](std::uint32_t wp, std::uint32_t wq) {
        add_difference(wp, wq, weight_[wq], d, more);
      });
      for (std::size_t k = 0; k < 6; ++k) batch.p[VertexRecord::kA + k][i] += more.a[k];
      batch.p[VertexRecord::kC][i] += more.c;
      for (std::size_t k = 0; k < 3; ++k) batch.p[VertexRecord::kB + k][i] += more.b[k];
    } else {
      float cost = deviation_[p_stays ? p : q];
      wedges_.for_each_pair(mesh_, h, [&](std::uint32_t wp, std::uint32_t wq) {
        cost += p_stays ? deviation(wq, {-d[0], -d[1], -d[2]}, wp) : deviation(wp, d, wq);
      });
      batch.p[VertexRecord::kC][i] += cost;
    }
  }
}

void AttributeQuadrics::add_to_ends(EdgeBatch& batch, std::span<const std::uint32_t> edges,
                                    EndCosts& costs) const {
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const std::uint32_t h = edges[i], p = mesh_.origin(h), q = mesh_.target(h);
    const Vector3 d = between(p, q);
    float at_p = deviation_[p], at_q = deviation_[q];
    wedges_.for_each_pair(mesh_, h, [&](std::uint32_t wp, std::uint32_t wq) {
      at_p += deviation(wq, {-d[0], -d[1], -d[2]}, wp);
      at_q += deviation(wp, d, wq);
    });
    costs.at[0][i] = at_p;
    costs.at[1][i] = at_q;
    if (wedges_.on_seam(p) != wedges_.on_seam(q)) lock(wedges_.on_seam(p) ? batch.p : batch.q, i);
  }
}

float AttributeQuadrics::geometric_cost(std::uint32_t p, std::uint32_t q, const Vector3& x) const {
  const Vector3 d = between(p, q);
  return plain_[p].value(x) + plain_[q].value(minus(x, d));
}

float AttributeQuadrics::weight(std::uint32_t v) const {
  float sum = 0;
  wedges_.for_each_at(mesh_, v, [&](std::uint32_t w) { sum += weight_[w]; });
  return sum;
}

void AttributeQuadrics::move(std::uint32_t wedge, const Vector3& by) {
  const std::size_t n = components_.size();
  for (std::size_t k = 0; k < n; ++k) {
    Function& f = function_[wedge * n + k];
    f.value += dot(f.gradient, by);
  }
}

void AttributeQuadrics::collapse(std::uint32_t h, const Vector3& move_gone, const Vector3& move_kept) {
  const std::uint32_t gone = mesh_.origin(h), kept = mesh_.target(h);
  plain_[gone].shift(move_gone);
  plain_[kept].shift(move_kept);
  plain_[kept].add(plain_[gone]);
  wedges_.for_each_at(mesh_, kept, [&](std::uint32_t w) { move(w, move_kept); });
  VertexRecord& vertex = mesh_.vertices[kept];
  constexpr Vector3 kSamePlace = {0.0f, 0.0f, 0.0f};
  wedges_.for_each_pair(mesh_, h, [&](std::uint32_t from, std::uint32_t to) {
    move(from, move_gone);
    add_difference(to, from, weight_[from], kSamePlace, vertex.quadric);
    join(to, from, weight_[from], kSamePlace);
  });
  if (keeps_changes_) keep_change(h, vertex.has(VertexRecord::kMoved) || move_kept != kSamePlace);
  wedges_.collapse(mesh_, h);
  deviation_[kept] = deviation(kept);
}

void AttributeQuadrics::join(std::uint32_t wedge_p, std::uint32_t wedge_q, float weight_q, const Vector3& d) {
  const std::size_t n = components_.size();
  const float part = share(weight_q, weight_[wedge_p]);
  for (std::size_t k = 0; k < n; ++k) {
    Function& f = function_[wedge_p * n + k];
    const Function& g = function_[wedge_q * n + k];
    const float value = g.value - dot(g.gradient, d);
    for (std::size_t j = 0; j < 3; ++j) f.gradient[j] += part * (g.gradient[j] - f.gradient[j]);
    f.value += part * (value - f.value);
  }
  weight_[wedge_p] += weight_q;
}

void AttributeQuadrics::prepare(RetriangulationAttributes& batch) const {
  for (const Component& component : components_) batch.components.emplace_back().cost = component.cost;
}

void AttributeQuadrics::set(RetriangulationAttributes& batch, std::size_t lane,
                            std::span<const std::uint32_t> edges, std::size_t neighbours,
                            const SeamSides& sides) const {
  const std::size_t n = components_.size();
  const Quadric& left = apart_[mesh_.origin(edges[0])];
  for (std::size_t k = 0; k < 6; ++k) batch.a[k][lane] = left.a[k];
  for (std::size_t k = 0; k < 3; ++k) batch.b[k][lane] = left.b[k];
  batch.c[lane] = left.c;
  batch.last[lane] = static_cast<std::int32_t>(sides.last);
  batch.split[lane] = sides.split ? 1 : 0;
  for (std::size_t side = 0; side < sides.count(); ++side) {
    const std::uint32_t own = wedges_.on_side(edges, sides, side);
    batch.weight[side][lane] = weight_[own];
    for (std::size_t k = 0; k < n; ++k) {
      RetriangulationAttributes::OnSide& on_side = batch.components[k].side[side];
      const Function& mean = function_[own * n + k];
      on_side.off[lane] = mean.value - value_[own * n + k];
      for (std::size_t j = 0; j < 3; ++j) on_side.gradient[j][lane] = mean.gradient[j];
    }
    for (std::size_t i = 0; i < neighbours; ++i) {
      if (!sides.has(side, i)) continue;
      const std::uint32_t wedge = wedges_.of_neighbour(edges, sides, side, i);
      for (std::size_t k = 0; k < n; ++k)
        batch.components[k].side[side].ring[i][lane] = value_[wedge * n + k] - value_[own * n + k];
    }
  }
}

void AttributeQuadrics::distribute_quadric(std::span<const std::uint32_t> edges, const SeamSides& sides,
                                           std::size_t neighbour, float part) {
  const std::uint32_t v = mesh_.origin(edges[0]), receiver = mesh_.target(edges[neighbour]);
  const Vector3 d = between(receiver, v);
  Quadric &left = apart_[receiver], moved = apart_[v];
  moved.shift({-d[0], -d[1], -d[2]});
  left.add(moved, part);
  for (std::size_t side = 0; side < sides.count(); ++side) {
    const std::uint32_t from = wedges_.on_side(edges, sides, side),
                        to = wedges_.of_neighbour(edges, sides, side, neighbour);
    add_difference(to, from, part * weight_[from], d, left);
    join(to, from, part * weight_[from], d);
  }
}

void AttributeQuadrics::append_values(std::uint32_t wedge, bool moved,
                                      std::vector<std::vector<float>>& values) const {
  const std::size_t n = components_.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Component& c = components_[k];
    double value = value_of(c.attribute, wedges_.source_corner(wedge), c.index);
    if (moved)
      value = std::clamp(c.middle + c.range * static_cast<double>(function_[wedge * n + k].value),
                         static_cast<double>(c.low), static_cast<double>(c.high));
    values[c.attribute].push_back(static_cast<float>(value));
  }
  for (std::size_t a = 0; moved && a < attributes_.size(); ++a) {
    if (attributes_[a].kind != AttributeKind::kNormal) continue;
    const std::span<float> normal(values[a].end() - 3, 3);
    const double x = normal[0], y = normal[1], z = normal[2], length = std::sqrt(x * x + y * y + z * z);
    if (!(length > 0)) continue;
    normal[0] = static_cast<float>(x / length);
    normal[1] = static_cast<float>(y / length);
    normal[2] = static_cast<float>(z / length);
  }
}

DecimatedAttributes AttributeQuadrics::gather(std::span<const std::uint32_t> faces,
                                              std::span<const std::uint32_t> new_face) const {
  DecimatedAttributes result;
  result.values.resize(attributes_.size());
  result.corners.resize(3 * faces.size());
  for (const std::uint32_t f : faces)
    for (std::uint32_t i = 0; i < 3; ++i)
      result.corners[3 * new_face[mesh_.face(4 * f).source] + i] = 4 * f + i;
  std::vector<std::uint32_t> number(wedges_.count(), kInvalid);  // in order of appearance
  for (std::uint32_t& corner : result.corners) {
    const std::uint32_t h = corner, w = wedges_[h];
    if (number[w] == kInvalid) {
      number[w] = static_cast<std::uint32_t>(result.source_corner.size());
      result.source_corner.push_back(wedges_.source_corner(w));
      append_values(w, mesh_.vertices[mesh_.origin(h)].has(VertexRecord::kMoved), result.values);
    }
    corner = number[w];
  }
  return result;
}

}  // namespace vkmesh::detail
