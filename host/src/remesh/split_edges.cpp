// Splits of long edges.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "remesh/remesh_state.h"

namespace vkmesh::detail {
namespace {

class Splitter {
 public:
  explicit Splitter(RemeshState& state) : state_(state), mesh_(state.mesh) {}

  std::size_t run() {
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      if (!mesh_.alive(4 * f)) continue;
      for (std::uint32_t h = 4 * f; h < 4 * f + 3; ++h)
        if (mesh_.is_ghost(mesh_.twin(h)) || h < mesh_.twin(h)) consider(h);
    }
    std::size_t splits = 0;
    while (!found_.empty()) {
      std::vector<Candidate> round;
      std::swap(round, found_);
      std::ranges::sort(round, [](const Candidate& a, const Candidate& b) {
        return a.excess != b.excess ? a.excess > b.excess : a.half_edge < b.half_edge;
      });
      // A split hands half-edges of its faces on to new records: they are found again, and the old ones name
      // other edges.
      for (const auto& [excess, h] : round) {
        if (state_.is_stopped(splits)) break;
        if (excess_of(h) == excess && is_longest_that_splits(h)) {
          if (split(h))
            ++splits;
          else
            refuse(h);
        }
      }
      if (state_.stop.is_set()) break;
    }
    if (has_refused_)
      for (std::uint32_t h = 0; h < mesh_.half_edge_bound(); ++h)
        if (h % 4 != 3 && mesh_.alive(h)) mesh_.clear_tag(h, kRefusedTag);
    return splits;
  }

 private:
  struct Candidate {
    double excess;
    std::uint32_t half_edge;  // of no ghost
  };

  [[nodiscard]] bool stays(std::uint32_t h) const {
    return mesh_.has_tag(h, kKeptTag) || mesh_.has_tag(h, kRefusedTag);
  }
  void refuse(std::uint32_t h) {
    for (const std::uint32_t side : {h, mesh_.twin(h)}) mesh_.set_tag(side, kRefusedTag);
    has_refused_ = true;
  }
  void consider(std::uint32_t h) {
    if (stays(h)) return;
    const double excess = excess_of(h);
    if (excess > kSplitBeyond * kSplitBeyond && is_longest_that_splits(h)) found_.push_back({excess, h});
  }
  [[nodiscard]] double excess_of(std::uint32_t h) const {
    const double target = state_.target(mesh_.origin(h), mesh_.target(h));
    return state_.squared_length(h) / (target * target);
  }

  /// Beside a longer edge that is kept there is no end of splits: some edge of its face is always too long.
  [[nodiscard]] bool is_longest_that_splits(std::uint32_t h) const {
    const double length2 = state_.squared_length(h);
    for (const std::uint32_t side : {h, mesh_.twin(h)}) {
      if (mesh_.is_ghost(side)) continue;
      for (const std::uint32_t e : {RemeshMesh::next(side), RemeshMesh::previous(side)})
        if (stays(e) && state_.squared_length(e) >= length2) return false;
    }
    return true;
  }

  bool split(std::uint32_t h) {
    const std::uint32_t p = mesh_.origin(h), q = mesh_.target(h), t = mesh_.twin(h);
    // Two faces back to back: two edges would join the new vertex to the one across.
    if (mesh_.origin(RemeshMesh::previous(h)) == mesh_.origin(RemeshMesh::previous(t))) return false;
    if (state_.splits_left == 0) return false;
    const RemeshVertex &from = mesh_.vertices[p], &to = mesh_.vertices[q];
    RemeshVertex middle = from;
    middle.length = 0.5f * (from.length + to.length);
    middle.valence = 4;
    middle.is_placed = 0;
    if (state_.is_curve(h)) {
      const std::uint32_t curve = state_.curve_of(h);
      middle.kind = VertexKind::kCurve;
      middle.place = curve;
      middle.along = 0.5 * (state_.along(curve, p) + state_.along(curve, q));
      middle.position = state_.rounded(state_.curves.at(curve, middle.along));
      if (!fits(h, middle.position) || (!mesh_.is_ghost(t) && !fits(t, middle.position))) return false;
    } else {
      middle.kind = VertexKind::kFree;
      middle.position = state_.rounded(0.5 * (from.position + to.position));
      middle.place =
          state_.surface.nearer_walk(state_.original_at(h).face, state_.original_at(t).face, middle.position)
              .face;
    }
    if (middle.position == from.position || middle.position == to.position) return false;
    if (!stays_near(h, middle.position) && middle.kind == VertexKind::kCurve) return false;
    state_.deviation.replace();
    middle.best_valence = mesh_.is_ghost(t) ? 5 : 6;
    if (middle.kind == VertexKind::kCurve) ++state_.curves.inside(middle.place);
    --state_.splits_left;
    const std::uint32_t m = mesh_.split(h);
    middle.leading = mesh_.vertices[m].leading;
    mesh_.vertices[m] = middle;
    std::uint32_t g = middle.leading;
    do {
      if (const std::uint32_t end = mesh_.target(g); end != mesh_.apex()) {
        if (end != p && end != q) ++mesh_.vertices[end].valence;
        consider(mesh_.is_ghost(g) ? mesh_.twin(g) : g);
      }
      if (!mesh_.is_ghost(g)) consider(RemeshMesh::next(g));
      g = mesh_.around_vertex(g);
    } while (g != middle.leading);
    return true;
  }

  /// Whether the halves of the faces at h, in the records that they will have, stay near the original.
  [[nodiscard]] bool stays_near(std::uint32_t h, const DVec3& middle) {
    if (!state_.deviation.is_set()) return true;
    gone_.clear();
    made_.clear();
    auto made = static_cast<std::uint32_t>(mesh_.face_count());
    for (const std::uint32_t side : {h, mesh_.twin(h)}) {
      if (mesh_.is_ghost(side)) continue;
      const DVec3 &p = state_.position(mesh_.origin(side)), &q = state_.position(mesh_.target(side)),
                  &a = state_.position(mesh_.origin(RemeshMesh::previous(side)));
      const std::uint32_t near = state_.original_near(side);
      gone_.push_back(side / 4);
      made_.push_back({side / 4, {middle, a, p}, near});
      made_.push_back({made++, {middle, q, a}, near});
    }
    return state_.deviation.allows(gone_, made_);
  }

  /// Whether the two halves of the face at h keep its side.
  [[nodiscard]] bool fits(std::uint32_t h, const DVec3& middle) const {
    const DVec3 &p = state_.position(mesh_.origin(h)), &q = state_.position(mesh_.target(h)),
                &a = state_.position(mesh_.origin(RemeshMesh::previous(h)));
    const DVec3 before = area_vector(p, q, a);
    return keeps_side(before, area_vector(p, middle, a), before, kCosMostTurn) &&
           keeps_side(before, area_vector(middle, q, a), before, kCosMostTurn);
  }

  RemeshState& state_;
  RemeshMesh& mesh_;
  std::vector<Candidate> found_;
  std::vector<std::uint32_t> gone_;
  std::vector<DeviationBound::Face> made_;
  bool has_refused_ = false;
};

}  // namespace

std::size_t split_long_edges(RemeshState& state) {
  return Splitter(state).run();
}

}  // namespace vkmesh::detail
