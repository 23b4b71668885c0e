#include "remesh/original_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "base/disjoint_sets.h"

namespace vkmesh::detail {
namespace {

std::uint32_t next(std::uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
std::uint32_t previous(std::uint32_t h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}

/// Where the nearest point of a triangle lies: inside, on the edge from corner i, or at corner i.
enum class Part : std::uint8_t { kInside, kEdge, kCorner };
struct Nearest {
  std::array<double, 3> weights;
  Part part;
  std::uint32_t i;
};

Nearest on_edge(std::uint32_t i, double t) {
  Nearest found{{0, 0, 0}, Part::kEdge, i};
  found.weights[i] = 1 - t;
  found.weights[(i + 1) % 3] = t;
  return found;
}
Nearest at_corner(std::uint32_t i) {
  Nearest found{{0, 0, 0}, Part::kCorner, i};
  found.weights[i] = 1;
  return found;
}

/// C. Ericson, "Real-time collision detection" (2005), §5.1.5: by the Voronoi regions of the corners and
/// edges.
Nearest nearest_of(const DVec3& p, const std::array<DVec3, 3>& corner) {
  const auto& [a, b, c] = corner;
  const DVec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return at_corner(0);
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return at_corner(1);
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return at_corner(2);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 - d3 > 0) return on_edge(0, d1 / (d1 - d3));
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 - d6 > 0) return on_edge(2, d6 / (d6 - d2));
  const double va = d3 * d6 - d5 * d4, bc = (d4 - d3) + (d5 - d6);
  if (va <= 0 && d4 >= d3 && d5 >= d6 && bc > 0) return on_edge(1, (d4 - d3) / bc);
  // Rounding counts in triangles of next to no area.
  const double u = std::max(va, 0.0), v = std::max(vb, 0.0), w = std::max(vc, 0.0), sum = u + v + w;
  if (!(sum > 0)) return at_corner(0);
  return {{u / sum, v / sum, w / sum}, Part::kInside, 0};
}

}  // namespace

DVec3 OriginalSurface::normal(std::uint32_t face) const {
  const auto corners = mesh_.origins().subspan(3 * std::size_t{face}, 3);
  const DVec3 a = position(corners[0]);
  return glm::cross(position(corners[1]) - a, position(corners[2]) - a);
}

void OriginalSurface::part_at(const std::vector<bool>& half_edges) {
  is_border_ = half_edges;
  const std::size_t faces = mesh_.face_count();
  DisjointSets sets(faces);
  for (std::uint32_t h = 0; h < mesh_.half_edge_count(); ++h) {
    const std::uint32_t t = mesh_.twins()[h];
    if (t != kInvalid && t > h && !is_border_[h]) sets.unite(h / 3, t / 3);
  }
  patch_.resize(faces);
  for (std::uint32_t f = 0; f < faces; ++f) patch_[f] = sets.find(f);
}

namespace {

struct Found {
  Foot foot;
  Part part;
  std::uint32_t i;
};

Found find_in(const OriginalSurface& surface, std::uint32_t face, const DVec3& p) {
  const std::uint32_t* const v = surface.mesh().origins().data() + 3 * std::size_t{face};
  const std::array<DVec3, 3> corner = {surface.position(v[0]), surface.position(v[1]),
                                       surface.position(v[2])};
  const Nearest nearest = nearest_of(p, corner);
  Found found{{face, nearest.weights, {}, 0}, nearest.part, nearest.i};
  if (nearest.part == Part::kCorner)
    found.foot.point = corner[nearest.i];
  else
    found.foot.point =
        nearest.weights[0] * corner[0] + nearest.weights[1] * corner[1] + nearest.weights[2] * corner[2];
  const DVec3 rest = p - found.foot.point;
  found.foot.distance2 = glm::dot(rest, rest);
  return found;
}

}  // namespace

Foot OriginalSurface::nearest_in(std::uint32_t face, const DVec3& p) const {
  return find_in(*this, face, p).foot;
}

Foot OriginalSurface::walk(std::uint32_t face, const DVec3& p) const {
  Found best = find_in(*this, face, p);
  while (best.part != Part::kInside) {
    const std::uint32_t h = 3 * best.foot.face + best.i;
    if (best.part == Part::kEdge) {
      const std::uint32_t t = across(h);
      if (t == kInvalid) break;
      const Found beyond = find_in(*this, t / 3, p);
      if (!(beyond.foot.distance2 < best.foot.distance2)) break;
      best = beyond;
      continue;
    }
    // Around the corner, counter-clockwise and, from a border, the other way.
    Found nearest = best;
    const auto look_at = [&](std::uint32_t g) {
      const Found there = find_in(*this, g / 3, p);
      if (there.foot.distance2 < nearest.foot.distance2) nearest = there;
    };
    std::uint32_t g = across(previous(h));
    for (; g != kInvalid && g != h; g = across(previous(g))) look_at(g);
    if (g == kInvalid)
      for (std::uint32_t t = across(h); t != kInvalid; t = across(next(t))) look_at(next(t));
    if (!(nearest.foot.distance2 < best.foot.distance2)) break;
    best = nearest;
  }
  return best.foot;
}

void OriginalSurface::build_tree() {
  if (tree_) return;
  tree_.emplace(positions_, mesh_.origins());
  leaf_.resize(mesh_.face_count());
  for (std::uint32_t i = 0; i < leaf_.size(); ++i) leaf_[tree_->sources()[i]] = i;
}

Foot OriginalSurface::search(const Foot& hint, const DVec3& p) const {
  std::uint32_t leaf = leaf_[hint.face];
  static_cast<void>(tree_->nearest(p / scale_, leaf));
  return nearest_in(tree_->sources()[leaf], p);
}

Foot OriginalSurface::search_same_side(const Foot& hint, const DVec3& p) const {
  const Foot found = search(hint, p);
  const bool fits = patch(found.face) == patch(hint.face) &&
                    glm::dot(normal(found.face), normal(hint.face)) > 0 && found.distance2 < hint.distance2;
  return fits ? found : hint;
}

}  // namespace vkmesh::detail
