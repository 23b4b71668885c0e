#include "remesh/feature_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "math/triangle_distance.h"

namespace vkmesh::detail {
namespace {

constexpr double kCosSharpTurn = 0.7071067811865476;  // 45 degrees

}  // namespace

FeatureCurves::FeatureCurves(const OriginalSurface& surface, const std::vector<bool>& is_curve,
                             const std::vector<bool>& is_locked, double reach)
    : surface_(surface), curve_of_(surface.mesh().vertex_count(), kNone) {
  const HalfEdgeMesh& mesh = surface.mesh();
  // The edges of curves at each vertex, by the half-edge that stands for the edge.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> at;
  const auto ends_of = [&](std::uint32_t e) { return mesh.vertices_of_edge(HalfEdgeId(e)); };
  mesh.for_each_edge([&](HalfEdgeId h) {
    const std::uint32_t t = mesh.twin(h).index;
    if (!is_curve[h.index] && (t == kInvalid || !is_curve[t])) return;
    for (const VertexId v : mesh.vertices_of_edge(h)) at.emplace_back(v.index, h.index);
  });
  if (at.empty()) {
    for (std::size_t v = 0; v < is_locked.size(); ++v)
      if (is_locked[v]) curve_of_[v] = kEnd;
    return;
  }
  std::ranges::sort(at);
  along_.resize(mesh.vertex_count());
  const auto edges_at = [&](std::uint32_t v) {
    const auto low = std::lower_bound(at.begin(), at.end(), std::pair(v, std::uint32_t{0}));
    auto high = low;
    while (high != at.end() && high->first == v) ++high;
    return std::span(low, high);
  };
  const auto other_end = [&](std::uint32_t e, std::uint32_t v) {
    const auto [a, b] = ends_of(e);
    return a.index == v ? b.index : a.index;
  };
  // The first vertex along edge e and on that is so far away, or where the curve ends.
  const auto reached = [&](std::uint32_t start, std::uint32_t e) {
    double length = 0;
    for (std::uint32_t v = start;;) {
      const std::uint32_t w = other_end(e, v);
      length += glm::length(surface.position(w) - surface.position(v));
      v = w;
      const auto edges = edges_at(v);
      if (length >= reach || edges.size() != 2 || v == start || is_locked[v]) return surface.position(v);
      e = edges[0].second == e ? edges[1].second : edges[0].second;
    }
  };
  const auto turns_sharply = [&](std::uint32_t v, std::uint32_t one, std::uint32_t other) {
    const auto is_sharp = [&](const DVec3& before, const DVec3& after) {
      const DVec3 from = surface.position(v) - before, to = after - surface.position(v);
      return !(glm::dot(from, to) >= kCosSharpTurn * std::sqrt(glm::dot(from, from) * glm::dot(to, to)));
    };
    return is_sharp(surface.position(other_end(one, v)), surface.position(other_end(other, v))) &&
           is_sharp(reached(v, one), reached(v, other));
  };
  for (std::size_t v = 0; v < is_locked.size(); ++v)
    if (is_locked[v]) curve_of_[v] = kEnd;
  for (std::size_t i = 0; i < at.size();) {
    const std::uint32_t v = at[i].first;
    const auto edges = edges_at(v);
    i += edges.size();
    if (edges.size() != 2 || turns_sharply(v, edges[0].second, edges[1].second)) curve_of_[v] = kEnd;
  }

  std::vector<bool> used(mesh.half_edge_count(), false);
  std::vector<std::uint32_t> path;
  // Follows the curve from a vertex up to one that ends it, or to where it began.
  const auto follow = [&](std::uint32_t start, std::uint32_t e) {
    path.assign(1, start);
    for (std::uint32_t v = start;;) {
      used[e] = true;
      v = other_end(e, v);
      path.push_back(v);
      if (curve_of_[v] == kEnd || v == start) return;
      const auto edges = edges_at(v);
      e = edges[0].second == e ? edges[1].second : edges[0].second;
    }
  };
  const auto add = [&](std::span<const std::uint32_t> part) {
    const auto curve = static_cast<std::uint32_t>(curves_.size());
    curves_.push_back({vertices_.size(), vertices_.size() + part.size(),
                       static_cast<std::uint32_t>(part.size() - 2), false});
    double length = 0;
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (i > 0) length += glm::length(surface.position(part[i]) - surface.position(part[i - 1]));
      vertices_.push_back(part[i]);
      lengths_.push_back(length);
      edges_.push_back(kInvalid);
      if (i + 1 < part.size()) {
        const auto edges = edges_at(part[i]);
        for (const auto& [from, e] : edges)
          if (other_end(e, part[i]) == part[i + 1]) edges_.back() = e;
        curves_.back().is_boundary = mesh.is_boundary(HalfEdgeId(edges_.back()));
      }
      if (i == 0 || i + 1 == part.size()) {
        curve_of_[part[i]] = kEnd;
        at_ends_.push_back({part[i], curve});
      } else {
        curve_of_[part[i]] = curve;
        along_[part[i]] = length;
      }
    }
  };
  const auto add_path = [&] {
    // A closed one is cut into three.
    const std::size_t pieces = path.front() == path.back() ? 3 : 1, n = path.size() - 1;
    for (std::size_t k = 0; k < pieces; ++k)
      add(std::span(path).subspan(k * n / pieces, (k + 1) * n / pieces - k * n / pieces + 1));
  };
  for (const bool ends : {true, false})
    for (const auto& [v, e] : at) {
      if (used[e] || (curve_of_[v] == kEnd) != ends) continue;
      follow(v, e);
      add_path();
    }
  std::ranges::sort(at_ends_, [](const At& a, const At& b) {
    return std::pair(a.from, a.curve) < std::pair(b.from, b.curve);
  });
}

std::pair<std::size_t, double> FeatureCurves::segment(std::uint32_t curve, double along) const {
  const auto [begin, end, inside, is_boundary] = curves_[curve];
  // The first vertex beyond, but the last at most.
  const auto first = lengths_.begin() + static_cast<std::ptrdiff_t>(begin) + 1,
             last = lengths_.begin() + static_cast<std::ptrdiff_t>(end) - 1;
  const auto beyond = static_cast<std::size_t>(std::upper_bound(first, last, along) - lengths_.begin());
  const double from = lengths_[beyond - 1], to = lengths_[beyond];
  return {beyond - 1, to > from ? std::clamp((along - from) / (to - from), 0.0, 1.0) : 0.0};
}

DVec3 FeatureCurves::at(std::uint32_t curve, double along) const {
  const auto [i, t] = segment(curve, along);
  return (1 - t) * surface_.position(vertices_[i]) + t * surface_.position(vertices_[i + 1]);
}

std::vector<std::pair<std::uint32_t, double>> FeatureCurves::short_ones(double length, double factor) const {
  std::vector<std::pair<std::uint32_t, double>> found;
  for (const Curve& curve : curves_)
    if (const double all = lengths_[curve.end - 1]; factor * all < length)
      for (std::size_t i = curve.begin; i < curve.end; ++i) found.emplace_back(vertices_[i], factor * all);
  return found;
}

double FeatureCurves::squared_deviation(std::uint32_t curve, double from, double to) const {
  if (from > to) std::swap(from, to);
  const std::size_t begin = segment(curve, from).first + 1;
  const DVec3 a = at(curve, from), b = at(curve, to);
  double largest = 0;
  for (std::size_t i = begin; i < curves_[curve].end && lengths_[i] < to; ++i)
    largest = std::max(largest, squared_distance_to_segment(surface_.position(vertices_[i]), a, b));
  return largest;
}

Foot FeatureCurves::beside(std::uint32_t curve, double along, bool left) const {
  const auto [i, t] = segment(curve, along);
  const HalfEdgeMesh& mesh = surface_.mesh();
  std::uint32_t h = edges_[i];
  const auto runs_along = [&, from = vertices_[i]] { return mesh.origins()[h] == from; };
  // Where all points coincide there is no telling left from right, and the other side may be none.
  if (runs_along() != left && mesh.twins()[h] != kInvalid) h = mesh.twins()[h];
  Foot foot{h / 3, {0, 0, 0}, at(curve, along), 0};
  const double at_origin = runs_along() ? 1 - t : t;
  foot.weights[h % 3] = at_origin;
  foot.weights[(h + 1) % 3] = 1 - at_origin;
  return foot;
}

std::uint32_t FeatureCurves::single_edge(std::uint32_t v, std::uint32_t w) const {
  const auto begin = std::ranges::lower_bound(at_ends_, v, {}, &At::from);
  for (auto it = begin; it != at_ends_.end() && it->from == v; ++it)
    if (curves_[it->curve].inside == 0 && (first(it->curve) == w || last(it->curve) == w)) return it->curve;
  return kNone;
}

}  // namespace vkmesh::detail
