// Collapses of short edges, and of the shortest sides of needles.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "mesh/edit/link_condition.h"
#include "mesh/edit/one_ring.h"
#include "remesh/remesh_state.h"

namespace vkmesh::detail {
namespace {

class Collapser {
 public:
  explicit Collapser(RemeshState& state) : state_(state), mesh_(state.mesh) {}

  /// Collapses those of these edges that are still there and for which `wants` says so, in the direction that
  /// leaves better shapes; those left must be better than `improves` asks.
  template <class Wants>
  std::size_t run(const std::vector<std::uint32_t>& edges, bool improves, Wants&& wants) {
    std::size_t collapses = 0, looked_at = 0;
    for (const std::uint32_t h : edges) {
      if (state_.is_stopped(looked_at++)) break;
      if (mesh_.alive(h) && wants(h)) collapses += collapse(h, improves) ? 1 : 0;
    }
    return collapses;
  }

 private:
  bool collapse(std::uint32_t h, bool improves) {
    const std::uint32_t t = mesh_.twin(h);
    if (mesh_.has_tag(h, kKeptTag) || (!may_go(h) && !may_go(t))) return false;
    ring_p_.gather(mesh_, h);
    ring_q_.gather(mesh_, t);
    const OneRing p = ring_p_.ring(), q = ring_q_.ring();
    if (!meets_link_condition(p.vertices, q.vertices, sorted_)) return false;
    if (mesh_.vertices[mesh_.origin(h)].is_free() && mesh_.vertices[mesh_.origin(t)].is_free()) {
      // Half-way new edges are half as much longer: an even mesh that is too dense could not get coarser
      // else.
      const DVec3 middle =
          state_.rounded(0.5 * (state_.position(mesh_.origin(h)) + state_.position(mesh_.origin(t))));
      if (judge_middle(h, p, q, middle, improves) && stays_near_middle(h, p, q, middle)) {
        const std::uint32_t place = state_.surface
                                        .nearer_walk(mesh_.vertices[mesh_.origin(h)].place,
                                                     mesh_.vertices[mesh_.origin(t)].place, middle)
                                        .face;
        apply(h, p);
        state_.deviation.replace();
        RemeshVertex& kept = mesh_.vertices[mesh_.origin(q.edges.front())];
        kept.position = middle;
        kept.place = place;
        kept.is_placed = 0;
        return true;
      }
    }
    const std::optional<double> one = judge(h, p, improves), other = judge(t, q, improves);
    // The better one first.
    const bool one_first = one && (!other || *one >= *other);
    for (const bool is_one : {one_first, !one_first}) {
      if (!(is_one ? one : other)) continue;
      if (!stays_near(is_one ? h : t, is_one ? p : q)) continue;
      apply(is_one ? h : t, is_one ? p : q);
      state_.deviation.replace();
      return true;
    }
    return false;
  }

  /// Whether the origin of h may become its target: curves stay, and so do their ends.
  [[nodiscard]] bool may_go(std::uint32_t h) const {
    const VertexKind kind = mesh_.vertices[mesh_.origin(h)].kind;
    return kind == VertexKind::kFree || (kind == VertexKind::kCurve && state_.is_curve(h));
  }

  /// The worst shape that is left around the origin of h; none where the collapse is illegal.
  [[nodiscard]] std::optional<double> judge(std::uint32_t h, const OneRing& ring, bool improves) const {
    if (!may_go(h)) return std::nullopt;
    const std::uint32_t p = mesh_.origin(h), q = mesh_.target(h);
    if (!keeps_curves(h, ring)) return std::nullopt;
    const DVec3 &from = state_.position(p), &to = state_.position(q);
    double worst_before = 3;
    const auto shape_before = [&](std::uint32_t v, std::uint32_t w) {
      worst_before = std::min(worst_before, shape_of(from, state_.position(v), state_.position(w)));
    };
    if (!mesh_.is_ghost(h)) shape_before(q, ring.vertices.front());
    if (!mesh_.is_ghost(mesh_.twin(h))) shape_before(ring.vertices.back(), q);
    Shapes shapes{worst_before, 3};
    if (!keeps_sides(ring, from, to, shapes)) return std::nullopt;
    if (improves ? !(shapes.after > shapes.before) : !(shapes.after >= std::min(shapes.before, kShape15)))
      return std::nullopt;
    if (!are_short(ring, to, state_.mesh.vertices[q].length)) return std::nullopt;
    return shapes.after;
  }

  /// The same for both ends, free ones, that become one at a place between them.
  [[nodiscard]] bool judge_middle(std::uint32_t h, const OneRing& p, const OneRing& q, const DVec3& middle,
                                  bool improves) const {
    const DVec3 &from = state_.position(mesh_.origin(h)), &to = state_.position(mesh_.target(h));
    Shapes shapes;
    for (const DVec3& a : {state_.position(p.vertices.front()), state_.position(p.vertices.back())})
      shapes.before = std::min(shapes.before, shape_of(from, to, a));
    if (!keeps_sides(p, from, middle, shapes) || !keeps_sides(q, to, middle, shapes)) return false;
    if (improves ? !(shapes.after > shapes.before) : !(shapes.after >= std::min(shapes.before, kShape15)))
      return false;
    const float length =
        std::min(mesh_.vertices[mesh_.origin(h)].length, mesh_.vertices[mesh_.target(h)].length);
    return are_short(p, middle, length) && are_short(q, middle, length);
  }

  struct Shapes {
    double before = 3, after = 3;
  };
  /// Whether the faces of a ring, which are of a vertex that moves, keep their sides; and their worst shapes.
  [[nodiscard]] bool keeps_sides(const OneRing& ring, const DVec3& from, const DVec3& to,
                                 Shapes& shapes) const {
    const auto for_each_face = [&](auto&& body) {
      for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
        if (ring.vertices[i] == mesh_.apex() || ring.vertices[i + 1] == mesh_.apex()) continue;
        const DVec3 &v = state_.position(ring.vertices[i]), &w = state_.position(ring.vertices[i + 1]);
        if (!body(v, w)) return false;
      }
      return true;
    };
    DVec3 around{0.0}, last_before{0.0}, last{0.0};
    for_each_face([&](const DVec3& v, const DVec3& w) {
      around += area_vector(from, v, w);
      shapes.before = std::min(shapes.before, shape_of(from, v, w));
      return true;
    });
    return for_each_face([&](const DVec3& v, const DVec3& w) {
      shapes.after = std::min(shapes.after, shape_of(to, v, w));
      const DVec3 area_before = area_vector(from, v, w), area = area_vector(to, v, w);
      if (!keeps_side(area_before, area, around, kCosMostTurn) || folds(last_before, last, area_before, area))
        return false;
      last_before = area_before;
      last = area;
      return true;
    });
  }
  /// Adds the faces around the origin of h as they are when it has moved.
  void add_faces(std::uint32_t h, const OneRing& ring, const DVec3& to) {
    const auto add = [&](std::uint32_t g) {
      if (!mesh_.is_ghost(g)) gone_.push_back(g / 4);
    };
    add(h);
    for (const std::uint32_t edge : ring.edges) add(edge);
    for (std::size_t i = 0; i + 1 < ring.size(); ++i)
      if (!mesh_.is_ghost(ring.edges[i]))
        made_.push_back({ring.edges[i] / 4,
                         {to, state_.position(ring.vertices[i]), state_.position(ring.vertices[i + 1])},
                         state_.original_near(ring.edges[i])});
  }
  /// Whether all stays near the original.
  [[nodiscard]] bool stays_near(std::uint32_t h, const OneRing& ring) {
    if (!state_.deviation.is_set()) return true;
    gone_.clear();
    made_.clear();
    add_faces(h, ring, state_.position(mesh_.target(h)));
    return state_.deviation.allows(gone_, made_);
  }
  [[nodiscard]] bool stays_near_middle(std::uint32_t h, const OneRing& p, const OneRing& q,
                                       const DVec3& middle) {
    if (!state_.deviation.is_set()) return true;
    if (!state_.deviation.is_near(middle, mesh_.vertices[mesh_.origin(h)].place)) return false;
    gone_.clear();
    made_.clear();
    add_faces(h, p, middle);
    // The two faces at the edge are there already.
    const std::size_t shared = gone_.size();
    add_faces(mesh_.twin(h), q, middle);
    for (const std::uint32_t g : {h, mesh_.twin(h)})
      if (const auto again =
              std::find(gone_.begin() + static_cast<std::ptrdiff_t>(shared), gone_.end(), g / 4);
          again != gone_.end())
        gone_.erase(again);
    return state_.deviation.allows(gone_, made_);
  }
  /// Whether edges to a place of this target length are not too long.
  [[nodiscard]] bool are_short(const OneRing& ring, const DVec3& to, float length) const {
    for (const std::uint32_t v : ring.vertices) {
      if (v == mesh_.apex()) continue;
      const DVec3 edge = state_.position(v) - to;
      const double longest = kLongestMade * static_cast<double>(std::min(mesh_.vertices[v].length, length));
      if (glm::dot(edge, edge) > longest * longest) return false;
    }
    return true;
  }

  /// Whether curves stay apart, and the edge that is made stays near its curve.
  [[nodiscard]] bool keeps_curves(std::uint32_t h, const OneRing& ring) const {
    // The faces at h go: two sides of each become one.
    const std::uint32_t t = mesh_.twin(h);
    const auto both = [&](std::uint32_t g) {
      return state_.is_curve(RemeshMesh::next(g)) && state_.is_curve(RemeshMesh::previous(g));
    };
    if (both(h) || both(t)) return false;
    if (mesh_.vertices[mesh_.origin(h)].kind != VertexKind::kCurve) return true;
    const std::uint32_t curve = mesh_.vertices[mesh_.origin(h)].place;
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (state_.is_curve(ring.edges[i]))
        return state_.curves.squared_deviation(curve, state_.along(curve, ring.vertices[i]),
                                               state_.along(curve, mesh_.target(h))) <=
               state_.tolerance2(curve);
    return false;
  }

  void apply(std::uint32_t h, const OneRing& ring) {
    const std::uint32_t p = mesh_.origin(h), q = mesh_.target(h);
    const RemeshVertex gone = mesh_.vertices[p];
    if (gone.kind == VertexKind::kCurve) --state_.curves.inside(gone.place);
    for (const std::uint32_t v : {ring.vertices.front(), ring.vertices.back()})
      if (v != mesh_.apex()) --mesh_.vertices[v].valence;
    mesh_.vertices[q].valence = (mesh_.vertices[q].valence + gone.valence - 4u) & ((1u << 20) - 1);
    for (const auto& [one, other] : mesh_.collapse(h, ring.edges).joined)
      for (const unsigned tag : {kCurveTag, kKeptTag})
        if (mesh_.has_tag(one, tag) || mesh_.has_tag(other, tag)) {
          mesh_.set_tag(one, tag);
          mesh_.set_tag(other, tag);
        }
  }

  RemeshState& state_;
  RemeshMesh& mesh_;
  LongRing ring_p_, ring_q_;
  std::vector<std::uint32_t> sorted_, gone_;
  std::vector<DeviationBound::Face> made_;
};

}  // namespace

std::size_t collapse_short_edges(RemeshState& state) {
  RemeshMesh& mesh = state.mesh;
  const auto shortness = [&](std::uint32_t h) {
    const double target = state.target(mesh.origin(h), mesh.target(h));
    return state.squared_length(h) / (target * target);
  };
  constexpr double kBelow = kCollapseBelow * kCollapseBelow;
  std::vector<std::pair<double, std::uint32_t>> found;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (!mesh.alive(4 * f)) continue;
    for (std::uint32_t h = 4 * f; h < 4 * f + 3; ++h)
      if (const std::uint32_t t = mesh.twin(h); mesh.is_ghost(t) || h < t)
        if (const double length = shortness(h); length < kBelow) found.emplace_back(length, h);
  }
  std::ranges::sort(found);
  std::vector<std::uint32_t> edges;
  for (const auto& [length, h] : found) edges.push_back(h);
  return Collapser(state).run(edges, false, [&](std::uint32_t h) { return shortness(h) < kBelow; });
}

std::size_t collapse_needles(RemeshState& state) {
  RemeshMesh& mesh = state.mesh;
  const auto shape = [&](std::uint32_t h) {
    return shape_of(state.position(mesh.origin(h)), state.position(mesh.target(h)),
                    state.position(mesh.origin(RemeshMesh::previous(h))));
  };
  std::vector<std::pair<double, std::uint32_t>> found;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (!mesh.alive(4 * f)) continue;
    const double s = shape(4 * f);
    if (s >= kShape30) continue;
    std::uint32_t shortest = 4 * f;
    for (const std::uint32_t h : {4 * f + 1, 4 * f + 2})
      if (state.squared_length(h) < state.squared_length(shortest)) shortest = h;
    found.emplace_back(s, shortest);
  }
  std::ranges::sort(found);
  std::vector<std::uint32_t> edges;
  for (const auto& [s, h] : found) edges.push_back(h);
  return Collapser(state).run(edges, true, [&](std::uint32_t h) { return shape(h) < kShape30; });
}

}  // namespace vkmesh::detail
