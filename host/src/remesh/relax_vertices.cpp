// Moves of vertices, over the surface and along its curves.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "remesh/remesh_state.h"

namespace vkmesh::detail {
namespace {

constexpr std::size_t kGrain = 1 << 10;
/// Moves shorter than this share of the target length are not worth the search for the surface.
constexpr double kLeastMove = 0.01;

/// Where a vertex would go.
struct Move {
  DVec3 position;
  std::uint32_t face = kInvalid;
  bool is_far = false;  // from where it was sent: another way to find the nearest point is called for
};

/// The mean of the places that make each of the faces around a free vertex equilateral, moved back along the
/// normal.
DVec3 middle_of(const RemeshState& state, std::uint32_t v) {
  const RemeshMesh& mesh = state.mesh;
  const RemeshVertex& vertex = mesh.vertices[v];
  const DVec3& p = vertex.position;
  DVec3 normal{0.0}, sides{0.0}, heights{0.0};
  double faces = 0;
  std::uint32_t h = vertex.leading;
  do {
    const DVec3 to_a = state.position(mesh.target(h)) - p,
                to_b = state.position(mesh.origin(RemeshMesh::previous(h))) - p,
                area = glm::cross(to_a, to_b);
    normal += area;
    sides += to_a;
    if (const double area2 = glm::dot(area, area); area2 > 0)
      heights += glm::cross(area, to_b - to_a) / std::sqrt(area2);
    ++faces;
    h = mesh.around_vertex(h);
  } while (h != vertex.leading);
  // Each side is of two faces, and the middle of two of them is below the apex.
  constexpr double kHeight = std::numbers::sqrt3 / 2;
  DVec3 move = (sides + kHeight * heights) / faces;
  if (const double n2 = glm::dot(normal, normal); n2 > 0) move -= glm::dot(move, normal) / n2 * normal;
  return p + move;
}

/// The faces around a vertex, and whether they may have it at another place.
class Star {
 public:
  explicit Star(RemeshState& state) : state_(state) {}

  void gather(std::uint32_t v) {
    const RemeshMesh& mesh = state_.mesh;
    const RemeshVertex& vertex = mesh.vertices[v];
    from_ = vertex.position;
    ring_.clear();
    edges_.clear();
    // What is free is not on the boundary; else the ring begins behind the two ghosts, if there are any.
    std::uint32_t h = vertex.leading, start = h;
    is_closed_ = true;
    if (!vertex.is_free()) {
      do {
        const std::uint32_t next = mesh.around_vertex(h);
        if (mesh.is_ghost(h) && !mesh.is_ghost(next)) {
          start = next;
          is_closed_ = false;
        }
        h = next;
      } while (h != vertex.leading);
    }
    h = start;
    do {
      ring_.push_back(state_.position(mesh.target(h)));
      edges_.push_back(h);
      h = mesh.around_vertex(h);
    } while (h != start && !mesh.is_ghost(h));
    if (!is_closed_) ring_.push_back(state_.position(mesh.target(h)));
  }

  [[nodiscard]] bool may_move(const DVec3& to) const {
    DVec3 around{0.0}, last_before{0.0}, last{0.0};
    bool has_flat = false, is_even = true;
    for (std::size_t i = 0; i < face_count(); ++i) {
      const auto [before, after] = areas(i, to);
      around += before;
      has_flat |= !(glm::dot(before, before) > 0);
      if (!keeps_side(before, after, before, kCosMostTurn) || folds(last_before, last, before, after))
        return false;
      last_before = before;
      last = after;
      is_even = is_even && is_shaped(to, ring_[i], second(i), after, kShape20);
    }
    if (is_closed_)
      if (const auto [before, after] = areas(0, to); folds(last_before, last, before, after)) return false;
    for (std::size_t i = 0; has_flat && i < face_count(); ++i)
      if (const auto [before, after] = areas(i, to); !keeps_side(before, after, around, kCosMostTurn))
        return false;
    return is_even || worst_shape(to) >= worst_shape(from_);
  }

  /// Whether the faces stay near the original; takes it as moved then. `near`: a face of the original there,
  /// for a free one.
  [[nodiscard]] bool stays_near(const DVec3& to, std::uint32_t near) {
    if (!state_.deviation.is_set()) return true;
    numbers_.clear();
    made_.clear();
    for (std::size_t i = 0; i < face_count(); ++i) {
      numbers_.push_back(edges_[i] / 4);
      made_.push_back({edges_[i] / 4,
                       {to, ring_[i], second(i)},
                       near != kInvalid ? near : state_.original_near(edges_[i])});
    }
    if (!state_.deviation.allows(numbers_, made_)) return false;
    state_.deviation.replace();
    return true;
  }

 private:
  [[nodiscard]] std::size_t face_count() const { return is_closed_ ? ring_.size() : ring_.size() - 1; }
  [[nodiscard]] const DVec3& second(std::size_t i) const { return ring_[i + 1 < ring_.size() ? i + 1 : 0]; }
  /// The area vectors of face i before and after the move.
  [[nodiscard]] std::array<DVec3, 2> areas(std::size_t i, const DVec3& to) const {
    return {area_vector(from_, ring_[i], second(i)), area_vector(to, ring_[i], second(i))};
  }
  [[nodiscard]] double worst_shape(const DVec3& p) const {
    double worst = 3;
    for (std::size_t i = 0; i < face_count(); ++i) worst = std::min(worst, shape_of(p, ring_[i], second(i)));
    return worst;
  }

  RemeshState& state_;
  DVec3 from_{0.0};
  std::vector<DVec3> ring_;           // around the vertex, counter-clockwise
  std::vector<std::uint32_t> edges_;  // to it, of the faces
  std::vector<std::uint32_t> numbers_;
  std::vector<DeviationBound::Face> made_;
  bool is_closed_ = true;
};

/// Moves a vertex half-way between its neighbours on the curve.
bool relax_on_curve(RemeshState& state, Star& star, std::uint32_t v) {
  RemeshMesh& mesh = state.mesh;
  RemeshVertex& vertex = mesh.vertices[v];
  const std::uint32_t curve = vertex.place;
  std::array<double, 2> ends{}, lengths{};
  std::size_t found = 0;
  std::uint32_t h = vertex.leading;
  do {
    if (state.is_curve(h) && found < 2) {
      ends[found] = state.along(curve, mesh.target(h));
      lengths[found++] = state.target(v, mesh.target(h));
    }
    h = mesh.around_vertex(h);
  } while (h != vertex.leading);
  const double share = lengths[0] / (lengths[0] + lengths[1]), middle = ends[0] + share * (ends[1] - ends[0]);
  const auto deviation = [&](double along) {
    return std::max(state.curves.squared_deviation(curve, ends[0], along),
                    state.curves.squared_deviation(curve, along, ends[1]));
  };
  const double most = std::max(state.tolerance2(curve), deviation(vertex.along));
  star.gather(v);
  for (const double step : {1.0, 0.5, 0.25}) {
    const double along = vertex.along + step * (middle - vertex.along);
    const DVec3 to = state.rounded(state.curves.at(curve, along));
    if (to == vertex.position) return false;
    if (deviation(along) > most || !star.may_move(to) || !star.stays_near(to, kInvalid)) continue;
    vertex.position = to;
    vertex.along = along;
    if (!state.lengths.is_uniform())
      vertex.length = state.lengths.at(state.surface, state.original_at(vertex.leading));
    return true;
  }
  return false;
}

}  // namespace

std::size_t relax_vertices(RemeshState& state) {
  RemeshMesh& mesh = state.mesh;
  const std::size_t count = mesh.vertex_bound();
  std::vector<Move> moves(count);
  parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
    if (state.stop.is_set()) return;
    for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
      if (v == mesh.apex() || !mesh.vertices[v].alive() || !mesh.vertices[v].is_free()) continue;
      const DVec3 to = middle_of(state, v), way = to - mesh.vertices[v].position;
      const double least = kLeastMove * static_cast<double>(mesh.vertices[v].length);
      if (mesh.vertices[v].is_placed && glm::dot(way, way) < least * least) continue;
      const Foot foot = state.surface.walk(mesh.vertices[v].place, to);
      // A surface that is not bent more than its edges are long lies within half of the way.
      moves[v] = {foot.point, foot.face, foot.distance2 > 0.25 * glm::dot(way, way)};
    }
  });
  std::vector<std::uint32_t> far;
  for (std::uint32_t v = 0; v < count; ++v)
    if (moves[v].is_far) far.push_back(v);
  if (!far.empty()) state.surface.build_tree();
  parallel_ranges(far.size(), kGrain / 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Move& move = moves[far[i]];
      const DVec3 to = middle_of(state, far[i]);
      const Foot foot = state.surface.search_same_side(state.surface.nearest_in(move.face, to), to);
      move = {foot.point, foot.face};
    }
  });
  Star star(state);
  std::size_t moved = 0;
  for (std::uint32_t v = 0; v < count; ++v) {
    if (state.is_stopped(v)) break;
    if (v == mesh.apex() || !mesh.vertices[v].alive()) continue;
    RemeshVertex& vertex = mesh.vertices[v];
    if (vertex.kind == VertexKind::kCurve) moved += relax_on_curve(state, star, v) ? 1 : 0;
    if (!vertex.is_free()) continue;
    if (moves[v].face == kInvalid) continue;
    Foot foot{moves[v].face, {}, moves[v].position, 0};
    star.gather(v);
    for (const double step : {1.0, 0.5, 0.25, 0.0}) {
      if (step < 1)
        foot =
            state.surface.walk(vertex.place, vertex.position + step * (moves[v].position - vertex.position));
      const DVec3 to = state.rounded(foot.point);
      if (to != vertex.position && !(star.may_move(to) && star.stays_near(to, foot.face))) continue;
      vertex.position = to;
      vertex.place = foot.face;
      vertex.is_placed = 1;
      ++moved;
      break;
    }
    if (!state.lengths.is_uniform())
      vertex.length =
          state.lengths.at(state.surface, state.surface.nearest_in(vertex.place, vertex.position));
  }
  return moved;
}

}  // namespace vkmesh::detail
