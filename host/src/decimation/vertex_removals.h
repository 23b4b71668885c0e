// Decimation by removing vertices and filling the holes they leave.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include <glm/geometric.hpp>

#include <vkmesh/mesh/handles.h>

#include "decimation/collapse_neighbourhood.h"
#include "decimation/cost/attribute_quadrics.h"
#include "decimation/cost/fan.h"
#include "decimation/cost/retriangulation.h"
#include "decimation/decimation_state.h"
#include "decimation/legality/criteria.h"
#include "decimation/legality/fold_over.h"
#include "decimation/legality/judge.h"
#include "decimation/legality/local_change.h"
#include "decimation/vertex_record.h"
#include "decimation/vertex_stars.h"
#include "mesh/edit/link_condition.h"
#include "mesh/edit/one_ring.h"
#include "simd/transpose.h"

namespace vkmesh::detail {

/// Vertex removals, the cheapest first.
///
/// Each vertex that may go stands in the queue once. One that cannot be removed is parked, and comes back
/// when a neighbour has gone: nothing else can make its removal legal.
template <class Queue, bool kAttributes = false>
class VertexRemovals {
 public:
  explicit VertexRemovals(DecimationState& state)
      : state_(state),
        mesh_(state.mesh),
        vertices_(state.mesh.vertices),
        queue_(vertices_.size(), vertices_.size()) {
    due_.reserve(kStars);
    if (state_.criteria != nullptr) batch_.shape = other_.shape = state_.criteria->shape_over_quadric();
    if constexpr (kAttributes) {
      state_.attributes->prepare(attributes_);
      state_.attributes->prepare(other_attributes_);
    }
  }

  static constexpr std::size_t kStep = Queue::kExact ? 1 : 512;

  /// All vertices with their costs.
  void fill() {
    std::array<std::uint32_t, kStars> ids;
    std::array<float, kStars> errors;
    std::size_t count = 0;
    const auto flush = [&] {
      errors.fill(kNone);
      stars_.walk(std::span(ids).first(count), [](std::uint32_t) {});
      evaluate([&](const VertexStar& star, std::size_t lane) {
        errors[stars_.index_of(star)] = rank(star, lane);
      });
      for (std::size_t i = 0; i < count; ++i) {  // in the order of the input
        if (errors[i] < kNone)
          queue_.fill(ids[i], errors[i]);
        else
          park(ids[i], Reason::kFoldOver);
      }
      count = 0;
      state_.ask();
    };
    for (std::uint32_t v = 0; v < mesh_.apex() && !state_.reached(); ++v) {
      const VertexRecord& vertex = vertices_[v];
      if (!vertex.alive()) continue;
      if (vertex.has(VertexRecord::kLocked)) {
        ++state_.outcome.rejected[Reason::kLocked];
        continue;
      }
      ids[count++] = v;
      if (count == kStars) flush();
    }
    flush();
    queue_.start();
  }

  /// Takes the next of the queue and removes those that are due and may go. False when nothing is left.
  bool step() {
    std::array<std::uint32_t, kStars> taken;
    const std::size_t count = queue_.take(taken);
    stars_.walk(std::span(taken).first(count), [&](std::uint32_t v) { park(v, Reason::kFoldOver); });
    due_.clear();
    std::array<Removal*, kStars> in_order{};
    evaluate([&](const VertexStar& star, std::size_t lane) {
      const float cost = rank(star, lane);
      if (!(cost < kNone))
        park(star.vertex, Reason::kFoldOver);
      else if (queue_.is_due(star.vertex, cost))
        in_order[stars_.index_of(star)] = &due_.emplace_back(removal_of(star, lane));
      else
        queue_.insert(star.vertex, cost);
    });
    find_existing();
    for (Removal* const removal : in_order) {
      if (removal == nullptr) continue;
      const std::uint32_t v = removal->star->vertex;
      if (vertices_[v].has(VertexRecord::kTouched) || state_.reached())
        queue_.insert_now(v);
      else
        attempt(*removal);
    }
    for (const std::uint32_t v : touched_) vertices_[v].source &= ~VertexRecord::kTouched;
    touched_.clear();
    return count > 0;
  }

  /// Counts what blocks each vertex that is left.
  void count_blocked() {
    const auto count = [&](Reason why) { ++state_.outcome.blocked[why]; };
    for (std::uint32_t v = 0; v < mesh_.apex() && !state_.reached(); ++v) {
      if (v % kRemovalsBetweenReports == 0) state_.ask();
      if (!vertices_[v].alive()) continue;
      if (vertices_[v].has(VertexRecord::kLocked)) {
        count(state_.boundary_kept && mesh_.on_boundary(v) ? Reason::kBoundary
              : is_fixed_by_seams(v)                       ? Reason::kSeam
                                                           : Reason::kLocked);
      } else if (vertices_[v].has(VertexRecord::kHasParked)) {
        stars_.walk(std::span(&v, 1), [&](std::uint32_t) { count(Reason::kFoldOver); });
        evaluate([&](const VertexStar& star, std::size_t lane) {
          if (!(batch_.error[lane] < kNone)) return count(Reason::kFoldOver);
          Removal removal = removal_of(star, lane);
          removal.has_existing = true;  // some may be so, which the triangulation must avoid
          count(judge_removal(removal));
        });
      }
    }
  }

 private:
  static constexpr float kNone = RetriangulationBatch::kNone;
  static constexpr std::size_t kStars = Queue::kExact ? 1 : 512;
  static constexpr std::size_t kMaxNeighbours = RetriangulationBatch::kMaxNeighbours;
  static_assert(CollapseMesh::kMaxHoleEdges >= kMaxNeighbours + 1);

  using Triangle = std::array<std::uint8_t, 3>;
  /// With what closes the boundary; each before those beyond its new edges.
  struct Triangles {
    std::array<Triangle, kMaxNeighbours> of;
    std::uint8_t count = 0;
    [[nodiscard]] std::span<const Triangle> all() const { return std::span(of).first(count); }
  };
  /// The neighbours that v's part of the surface falls to, and how much of it to each.
  struct Receivers {
    std::array<std::uint8_t, 3> neighbour;
    std::array<float, 3> share{};
  };
  struct Removal {
    const VertexStar* star;
    float error, of_attributes;
    Triangles triangles;
    Receivers receivers;
    std::int32_t heir;             // whose fan fills the hole; else -1
    bool has_existing;             // a new edge that the mesh has already
    bool is_filled_again = false;  // to avoid such edges
  };
  /// A walk around an end of a new edge, in search of the other: outside the star.
  struct Search {
    std::uint32_t from, last, other;
    Removal* removal;
  };

  /// At which edge the face is whose place the first new triangle takes: triangles take those of their side,
  /// those of side 1 first.
  [[nodiscard]] static std::size_t first_face([[maybe_unused]] const VertexStar& star) {
    if constexpr (kAttributes)
      if (star.sides.split) return star.sides.last % (star.ring.size - 1);
    return 0;
  }

  /// Calls use(star, lane) for all stars that were walked, with their holes filled in that lane of batch_.
  template <class Use>
  void evaluate(Use&& use) {
    const std::span<const std::uint32_t> order = stars_.in_order();
    for (std::size_t n = 1; n <= kMaxNeighbours; ++n)
      for (std::size_t from = stars_.first(n); from < stars_.first(n + 1);
           from += RetriangulationBatch::kLanes) {
        const std::size_t count = std::min(stars_.first(n + 1) - from, RetriangulationBatch::kLanes);
        set(batch_, attributes_, order.subspan(from, count));
        const std::size_t next = from + count;
        for (const std::uint32_t i :
             order.subspan(next, std::min(order.size() - next, RetriangulationBatch::kLanes))) {
          const VertexStar& star = stars_[i];
          prefetch(&vertices_[star.vertex]);
          for (std::size_t k = 0; k < star.neighbours(); ++k) prefetch(&vertices_[star.ring.vertex[k]]);
        }
        fill(batch_, attributes_, n, count);
        for (std::size_t lane = 0; lane < count; ++lane) use(stars_[order[from + lane]], lane);
      }
  }

  struct None {};
  using Attributes = std::conditional_t<kAttributes, RetriangulationAttributes, None>;

  /// Fills the holes of the first `count` lanes; by a fan where there is no triangulation seen along a
  /// normal.
  void fill(RetriangulationBatch& batch, Attributes& attributes, std::size_t neighbours,
            std::size_t count) const {
    RetriangulationAttributes* of_attributes = nullptr;
    if constexpr (kAttributes) of_attributes = &attributes;
    const float cos_deviation = state_.limits.cos_deviation;
    retriangulate(batch, neighbours, cos_deviation, of_attributes);
    for (std::size_t lane = 0; lane < count; ++lane)
      if (!(batch.error[lane] < kNone)) fill_with_fan(batch, neighbours, lane, cos_deviation, of_attributes);
  }

  /// Puts walked stars, all of as many neighbours, into the lanes from 0 on. Four records are turned at a
  /// time from rows to columns.
  void set(RetriangulationBatch& batch, [[maybe_unused]] Attributes& attributes,
           std::span<const std::uint32_t> walked) const {
    if constexpr (kAttributes)
      for (std::size_t lane = 0; lane < walked.size(); ++lane) {
        const VertexStar& star = stars_[walked[lane]];
        const std::size_t n = star.neighbours();
        state_.attributes->set(attributes, lane, star.edges(), n, star.sides);
        for (std::size_t b = 1; b < n; ++b)
          for (std::size_t a = 0; a < b; ++a)
            batch.barred[RetriangulationBatch::pair(a, b)][lane] = star.sides.cross(a, b) ? kNone : 0.0f;
        state_.attributes->wedges().for_each_end(mesh_, star.edges(), [&](std::size_t i) {
          for (std::size_t k = 2; k + 1 < n; ++k) {
            const std::size_t other = (i + k) % n;
            batch.barred[RetriangulationBatch::pair(std::min(i, other), std::max(i, other))][lane] = kNone;
          }
        });
      }
    if (state_.boundary_kept)
      for (std::size_t lane = 0; lane < walked.size(); ++lane) bar_ears(batch, stars_[walked[lane]], lane);
    alignas(16) std::array<float, 4> unused;
    for (std::size_t lane = 0; lane < walked.size(); lane += 4) {
      std::array<const VertexStar*, 4> stars;
      std::array<const void*, 4> records;
      for (std::size_t i = 0; i < 4; ++i) {
        stars[i] = &stars_[walked[std::min(lane + i, walked.size() - 1)]];
        batch.closed[lane + i] = stars[i]->closed ? 1.0f : 0.0f;
        records[i] = &vertices_[stars[i]->vertex];
      }
      const std::array<float*, 16> to = {
          &batch.v[0][lane],   &batch.v[1][lane], &batch.v[2][lane], unused.data(),
          &batch.weight[lane], &batch.a[0][lane], &batch.a[1][lane], &batch.a[2][lane],
          &batch.a[3][lane],   &batch.a[4][lane], &batch.a[5][lane], &batch.c[lane],
          &batch.b[0][lane],   &batch.b[1][lane], &batch.b[2][lane], unused.data()};
      transpose_records<16>(records, [&](std::size_t word) { return to[word]; });
      for (std::size_t k = 0; k < stars[0]->neighbours(); ++k) {
        for (std::size_t i = 0; i < 4; ++i) records[i] = &vertices_[stars[i]->ring.vertex[k]];
        auto& [x, y, z] = batch.ring[k];
        transpose_4x4(records, {&x[lane], &y[lane], &z[lane], unused.data()});
      }
    }
  }

  /// Bars the new edges that would leave a face with two sides on a boundary that is kept, for good, unless
  /// it looks about where the faces looked that were there: the curve alone says where it does.
  void bar_ears(RetriangulationBatch& batch, const VertexStar& star, std::size_t lane) const {
    const std::size_t n = star.neighbours();
    if constexpr (!kAttributes)
      for (std::size_t ab = 0; ab < RetriangulationBatch::pair(0, n); ++ab) batch.barred[ab][lane] = 0;
    if (!star.closed) return;
    const auto at = [&](std::size_t i) { return point_of(vertices_[star.ring.vertex[i % n]].position); };
    const DVec3 v = point_of(vertices_[star.vertex].position);
    for (std::size_t i = 0; i < n; ++i)
      if (mesh_.is_ghost(beyond(star, i)) && mesh_.is_ghost(beyond(star, (i + 1) % n)) &&
          !ear_stays_in_place(v, at(i), at(i + 1), at(i + 2))) {
        const std::size_t k = (i + 2) % n, edge = RetriangulationBatch::pair(std::min(i, k), std::max(i, k));
        batch.barred[n > 3 ? edge : RetriangulationBatch::pair(0, 2)][lane] = kNone;
      }
  }

  /// Calls use(a, b) for the neighbours at the ends of each new edge.
  template <class Use>
  static void for_new_edges(const VertexStar& star, const Triangles& triangles, Use&& use) {
    for (const auto& [a, b, c] : triangles.all()) {
      if (b > a + 1) use(a, b);
      if (c > b + 1 && c < star.neighbours()) use(b, c);
    }
  }

  /// Sets has_existing of all that are due, by walks around one end of each new edge.
  void find_existing() {
    searches_.clear();
    for (Removal& removal : due_) {
      const VertexStar& star = *removal.star;
      for (std::size_t i = 0; i < star.ring.size; ++i)
        prefetch(&mesh_.face(beyond(star, i)));  // to be joined
      for_new_edges(star, removal.triangles, [&](std::size_t a, std::size_t b) {
        const std::uint32_t before = star.ring.edge[a > 0 ? a - 1 : star.ring.size - 1];
        searches_.push_back({CollapseMesh::previous(before), CollapseMesh::next(star.ring.edge[a]),
                             star.ring.vertex[b], &removal});
      });
    }
    walks_.start(kSearched);
    for (Search& search : searches_) walks_.add(search.from, search.last, search);
    walks_.walk(
        mesh_,
        [](Search& search, std::uint32_t, const RingStep& step, bool) {
          const bool found = step.vertex == search.other;
          search.removal->has_existing |= found;
          return !found;
        },
        [this](Search& search) {
          search.removal->has_existing |= mesh_.has_edge(mesh_.origin(search.last), search.other);
        });
  }

  /// Removes a vertex, if that is legal.
  void attempt(Removal& removal) {
    const VertexStar& star = *removal.star;
    const std::uint32_t v = star.vertex;
    const Reason reason = judge_removal(removal);
    if (removal.is_filled_again && removal.error < kNone) {
      const float cost = cost_of(removal);
      if (!queue_.is_due(v, cost)) return queue_.insert(v, cost);
    }
    if (reason != Reason::kNone) return park(v, reason);
    remove(removal);
  }

  /// A removal as judge() takes it.
  struct Change : AlwaysLegal {
    VertexRemovals& self;
    Removal& removal;

    [[nodiscard]] const VertexStar& star() const { return *removal.star; }
    [[nodiscard]] bool keeps_seams() const {
      if constexpr (kAttributes)
        return self.state_.attributes->wedges().keeps_seams(self.mesh_, star().edges(), star().sides);
      return true;
    }
    [[nodiscard]] bool exceeds_error() const {
      return static_cast<double>(removal.error) >
             self.state_.limits.error2 * static_cast<double>(self.vertices_[star().vertex].weight);
    }
    /// Fills the hole again if the mesh has a new edge already.
    [[nodiscard]] bool meets_link_condition() const {
      if (is_tip_of_tetrahedron(self.mesh_, star().edges())) return false;
      for_new_edges(star(), removal.triangles, [&](std::size_t a, std::size_t b) {  // made a moment ago?
        const std::uint32_t p = star().ring.vertex[a], q = star().ring.vertex[b];
        if (self.vertices_[p].has(VertexRecord::kTouched) && self.vertices_[q].has(VertexRecord::kTouched))
          removal.has_existing |= self.mesh_.has_edge(p, q);
      });
      if (removal.has_existing) self.avoid_existing(removal);
      return removal.error < kNone && !(removal.is_filled_again && exceeds_error());
    }
    [[nodiscard]] bool folds_over() const {
      if (removal.heir >= 0)
        return self.folds_over_as_collapse(star(), static_cast<std::size_t>(removal.heir));
      const std::span<const std::uint32_t> ring = std::span(star().ring.vertex).first(star().neighbours());
      return detail::folds_over(self.vertices_, star().vertex, ring, star().closed, removal.triangles.all());
    }
    [[nodiscard]] bool meets_criteria() const {
      const Criteria* const criteria = self.state_.criteria;
      return criteria == nullptr || !criteria->bounds() || self.meets_criteria(star(), removal.triangles);
    }
  };
  /// A fan is what the collapse of the half-edge to its neighbour leaves.
  [[nodiscard]] bool folds_over_as_collapse(const VertexStar& star, std::size_t heir) {
    const std::uint32_t h = star.ring.edge[heir];
    const Vector3 from = vertices_[star.vertex].position, to = vertices_[star.ring.vertex[heir]].position;
    ring_p_.gather(mesh_, h);
    ring_q_.gather(mesh_, mesh_.twin(h));
    neighbourhood_.set(vertices_, ring_p_.ring(), ring_q_.ring());
    return detail::folds_over(neighbourhood_, from, to, minus(to, from), state_.limits.cos_deviation);
  }
  [[nodiscard]] Reason judge_removal(Removal& removal) {
    const Reason reason = judge(Change{{}, *this, removal});
    // Without the edges that are there already it may cost more than it did.
    const bool costs_more = removal.is_filled_again && removal.error < kNone;
    return reason == Reason::kLinkCondition && costs_more ? Reason::kErrorBound : reason;
  }

  /// What the queue holds a vertex under; kNone when it can not go.
  [[nodiscard]] float rank(const VertexStar& star, std::size_t lane) {
    const float error = batch_.error[lane];
    if (!(error < kNone)) return error;
    if (state_.criteria == nullptr || !state_.criteria->ranks())
      return error + error_of_attributes(attributes_, lane);
    return cost_of(removal_of(star, lane));
  }
  [[nodiscard]] float cost_of(const Removal& removal) {
    const float error = removal.error + removal.of_attributes;
    if (state_.criteria == nullptr || !state_.criteria->ranks()) return error;
    record_removal(*removal.star, removal.triangles);
    return state_.criteria->cost(error, vertices_[removal.star->vertex].weight, change_);
  }
  [[nodiscard]] static float error_of_attributes([[maybe_unused]] const Attributes& attributes,
                                                 [[maybe_unused]] std::size_t lane) {
    if constexpr (kAttributes) return attributes.error[lane];
    return 0;
  }

  [[nodiscard]] bool meets_criteria(const VertexStar& star, const Triangles& triangles) {
    record_removal(star, triangles);
    std::array<std::size_t, kMaxNeighbours> gained{};
    for_new_edges(star, triangles, [&](std::size_t a, std::size_t b) { ++gained[a], ++gained[b]; });
    for (std::size_t i = 0; i < star.neighbours(); ++i)
      if (gained[i] > 1)
        change_.edges_after = std::max(change_.edges_after, edges_at(star.ring.vertex[i]) - 1 + gained[i]);
    return state_.criteria->allow(change_);
  }

  /// The number of edges at a vertex, without that to the apex.
  [[nodiscard]] std::size_t edges_at(std::uint32_t v) const {
    std::size_t edges = 0;
    std::uint32_t h = vertices_[v].leading;
    do {
      edges += mesh_.target(h) != mesh_.apex() ? 1 : 0;
      h = mesh_.around_vertex(h);
    } while (h != vertices_[v].leading);
    return edges;
  }

  /// What a removal changes, into change_: new faces get the records of the old ones in turn.
  void record_removal(const VertexStar& star, const Triangles& triangles) {
    change_.clear();
    const DVec3 here = point_of(vertices_[star.vertex].position);
    change_.inner_before.push_back(here);
    double length2 = 0;
    for (std::size_t i = 0; i < star.neighbours(); ++i) {
      const DVec3 way = point_of(vertices_[star.ring.vertex[i]].position) - here;
      length2 += glm::dot(way, way);
    }
    change_.length2 = length2 / static_cast<double>(star.neighbours());
    for (const std::uint32_t h : star.edges())
      if (!mesh_.is_ghost(h)) change_.before.push_back(face_of(mesh_, h >> 2));
    const std::size_t first = first_face(star);
    for (const auto& corners : triangles.all()) {
      if (corners[2] == star.neighbours()) continue;  // closes the boundary
      LocalChange::Face face{{}, star.ring.edge[(first + change_.after.size()) % (star.ring.size - 1)] >> 2};
      for (std::size_t i = 0; i < 3; ++i)
        face.corner[i] = point_of(vertices_[star.ring.vertex[corners[i]]].position);
      change_.after.push_back(face);
    }
    // An ear of the boundary leaves nothing in its place but the face beside it.
    if (change_.after.empty()) {
      const LocalChange::Face beside = face_of(mesh_, beyond(star, 0) >> 2);
      change_.before.push_back(beside);
      change_.after.push_back(beside);
    }
  }

  /// Fills the hole again, without the edges that the mesh has already.
  void avoid_existing(Removal& removal) {
    const VertexStar& star = *removal.star;
    const auto walked = static_cast<std::uint32_t>(stars_.index_of(star));
    set(other_, other_attributes_, std::span(&walked, 1));
    while (bar_existing(star, removal.triangles)) {
      fill(other_, other_attributes_, star.neighbours(), 1);
      removal.is_filled_again = true;
      removal.error = other_.error[0];
      removal.of_attributes = error_of_attributes(other_attributes_, 0);
      if (!(removal.error < kNone)) break;
      removal.triangles = triangles_of(other_, 0, star);
      removal.receivers = receivers_of(other_, 0, star);
      removal.heir = other_.heir[0];
    }
    for (auto& barred : other_.barred) barred[0] = 0;
  }

  /// Beyond the face between neighbour i and the next.
  [[nodiscard]] std::uint32_t beyond(const VertexStar& star, std::size_t i) const {
    return mesh_.twin(CollapseMesh::next(star.ring.edge[i]));
  }

  [[nodiscard]] Removal removal_of(const VertexStar& star, std::size_t lane) const {
    return {&star,
            batch_.error[lane],
            error_of_attributes(attributes_, lane),
            triangles_of(batch_, lane, star),
            receivers_of(batch_, lane, star),
            batch_.heir[lane],
            false};
  }

  [[nodiscard]] static Triangles triangles_of(const RetriangulationBatch& batch, std::size_t lane,
                                              const VertexStar& star) {
    Triangles triangles;
    std::array<std::array<std::uint8_t, 2>, kMaxNeighbours> gaps;
    std::size_t gap_count = 0;
    const auto last = static_cast<std::uint8_t>(star.neighbours() - 1);
    if (!star.closed) triangles.of[triangles.count++] = {0, last, static_cast<std::uint8_t>(last + 1)};
    if (last > 1) gaps[gap_count++] = {0, last};
    while (gap_count > 0) {
      const auto [a, c] = gaps[--gap_count];
      const auto b = static_cast<std::uint8_t>(batch.third[RetriangulationBatch::pair(a, c)][lane]);
      triangles.of[triangles.count++] = {a, b, c};
      if (b > a + 1) gaps[gap_count++] = {a, b};
      if (c > b + 1) gaps[gap_count++] = {b, c};
    }
    if constexpr (kAttributes)
      if (star.sides.split)
        std::stable_partition(triangles.of.begin(), triangles.of.begin() + triangles.count,
                              [&](const Triangle& t) { return star.sides.of(t[2]) == 1; });
    return triangles;
  }

  /// Bars each new edge that the mesh has already in other_; whether there was one.
  bool bar_existing(const VertexStar& star, const Triangles& triangles) {
    bool found = false;
    for_new_edges(star, triangles, [&](std::size_t a, std::size_t b) {
      if (!mesh_.has_edge(star.ring.vertex[a], star.ring.vertex[b])) return;
      other_.barred[RetriangulationBatch::pair(a, b)][0] = kNone;
      found = true;
    });
    return found;
  }

  [[nodiscard]] bool is_fixed_by_seams([[maybe_unused]] std::uint32_t v) const {
    if constexpr (kAttributes) return state_.attributes->wedges().is_fixed(v);
    return false;
  }

  void park(std::uint32_t v, Reason why) {
    ++state_.outcome.rejected[why];
    vertices_[v].source |= VertexRecord::kHasParked;
  }

  void remove(const Removal& removal) {
    const VertexStar& star = *removal.star;
    VertexRecord& gone = vertices_[star.vertex];
    std::uint32_t receiver = 0;
    float most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const float share = removal.receivers.share[i];
      if (!(share > 0)) continue;
      const std::uint32_t r = star.ring.vertex[removal.receivers.neighbour[i]];
      if (share > most) receiver = r;
      most = std::max(most, share);
      absorb(vertices_[r], gone, share);
      if constexpr (kAttributes)
        state_.attributes->distribute_quadric(star.edges(), star.sides, removal.receivers.neighbour[i],
                                              share);
    }
    if (gone.weight > 0)
      state_.outcome.error2 = std::max(state_.outcome.error2,
                                       static_cast<double>(removal.error) / static_cast<double>(gone.weight));
    if constexpr (kAttributes) {
      if (const float weight = state_.attributes->weight(star.vertex); weight > 0)
        state_.outcome.attribute_error2 =
            std::max(state_.outcome.attribute_error2,
                     static_cast<double>(removal.of_attributes) / static_cast<double>(weight));
      state_.attributes->fill_hole(star.edges(), star.neighbours(), star.sides, removal.triangles.all(),
                                   first_face(star));
    }
    if (state_.criteria != nullptr && state_.criteria->bounds()) state_.criteria->keep(change_);
    const auto faces = mesh_.fill_hole(star.edges(), removal.triangles.all(), first_face(star));
    gone.leading = VertexRecord::kGone | receiver;
    if (state_.keep_events) keep_faces(removal);
    if (state_.keep_events)
      state_.outcome.events.push_back({vertices_[receiver].source & VertexRecord::kSourceMask,
                                       gone.source & VertexRecord::kSourceMask, vertices_[receiver].position,
                                       false, faces});
    state_.faces -= star.closed ? 2 : 1;
    --state_.vertices;
    ++state_.outcome.collapses;
    const auto ring = std::span(star.ring.vertex).first(star.neighbours());
    for (const std::uint32_t r : ring) {
      revive(r);
      vertices_[r].source |= VertexRecord::kTouched;
      touched_.push_back(r);
    }
    if (state_.criteria == nullptr || !state_.criteria->bounds()) return;
    // Bounds of valence look one vertex farther.
    for (const std::uint32_t r : ring) {
      std::uint32_t h = vertices_[r].leading;
      do {
        if (const std::uint32_t v = mesh_.target(h); v != mesh_.apex()) revive(v);
        h = mesh_.around_vertex(h);
      } while (h != vertices_[r].leading);
    }
  }

  /// The new faces, which are in the mesh, as part of the step that is next.
  void keep_faces(const Removal& removal) {
    const VertexStar& star = *removal.star;
    const auto step = static_cast<std::uint32_t>(state_.outcome.events.size());
    std::size_t taken = first_face(star);
    for (const auto& corners : removal.triangles.all()) {
      if (corners[2] == star.neighbours()) continue;  // closes the boundary
      const std::uint32_t h = star.ring.edge[taken % (star.ring.size - 1)] & ~3u;
      ++taken;
      auto& made = state_.outcome.changed_faces.emplace_back();
      made.step = step;
      made.face = mesh_.face(h).source;
      for (std::uint32_t i = 0; i < 3; ++i) {
        made.vertices[i] = vertices_[mesh_.origin(h + i)].source & VertexRecord::kSourceMask;
        if constexpr (kAttributes) {
          const Wedges& wedges = state_.attributes->wedges();
          made.wedges[i] = wedges.source_corner(wedges[h + i]);
        }
      }
    }
  }

  /// Puts a vertex in the queue again whose star has changed.
  void revive(std::uint32_t v) {
    VertexRecord& vertex = vertices_[v];
    if (vertex.has(VertexRecord::kHasParked) || (Queue::kExact && !vertex.has(VertexRecord::kLocked)))
      queue_.insert_now(v);
    vertex.source &= ~VertexRecord::kHasParked;
  }

  /// The corners of the triangle that holds v, by v's place in it; on a boundary or seam the ends of the new
  /// edge, by the point nearest to v.
  [[nodiscard]] Receivers receivers_of(const RetriangulationBatch& batch, std::size_t lane,
                                       const VertexStar& star) const {
    if (const std::int32_t heir = batch.heir[lane]; heir >= 0)
      return {{static_cast<std::uint8_t>(heir), 0, 0}, {1, 0, 0}};
    std::size_t a = 0, c = star.neighbours() - 1;
    bool on_curve = !star.closed;
    if constexpr (kAttributes) {
      if (star.sides.split) {
        on_curve = true;
        c = star.sides.last;
      }
    }
    Receivers receivers{{0, static_cast<std::uint8_t>(c), static_cast<std::uint8_t>(c)}};
    if (on_curve) {
      float along = 0, squared = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const float d = batch.ring[c][k][lane] - batch.ring[0][k][lane];
        along -= (batch.ring[0][k][lane] - batch.v[k][lane]) * d;
        squared += d * d;
      }
      const float t = squared > 0 ? std::clamp(along / squared, 0.0f, 1.0f) : 0.0f;
      receivers.share = {1 - t, t, 0};
      return receivers;
    }
    while (true) {
      const std::size_t ac = RetriangulationBatch::pair(a, c);
      const auto b = static_cast<std::size_t>(batch.third[ac][lane]);
      const float at_a = batch.left[RetriangulationBatch::pair(b, c)][lane],
                  at_c = batch.left[RetriangulationBatch::pair(a, b)][lane];
      if (at_c < 0) {
        c = b;
      } else if (at_a < 0) {
        a = b;
      } else {
        const float at_b = std::max(-batch.left[ac][lane], 0.0f), sum = at_a + at_b + at_c;
        receivers.neighbour = {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b),
                               static_cast<std::uint8_t>(c)};
        receivers.share = {1, 0, 0};
        if (sum > 0) receivers.share = {at_a / sum, at_b / sum, at_c / sum};
        return receivers;
      }
    }
  }

  /// Adds a share of the quadric of `gone` to that of `receiver`.
  static void absorb(VertexRecord& receiver, const VertexRecord& gone, float share) {
    Quadric moved = gone.quadric;
    moved.shift(minus(receiver.position, gone.position));
    receiver.quadric.add(moved, share);
    receiver.weight += share * gone.weight;
  }

  static constexpr std::uint32_t kSearched = 33;

  DecimationState& state_;
  CollapseMesh& mesh_;
  LargeArray<VertexRecord>& vertices_;
  Queue queue_;
  VertexStars<kStars> stars_{mesh_, kAttributes ? &state_.attributes->wedges() : nullptr};
  RetriangulationBatch batch_, other_;
  [[no_unique_address]] Attributes attributes_;  // at batch_
  [[no_unique_address]] Attributes other_attributes_;
  LongRing ring_p_, ring_q_;  // of a collapse that a fan stands for
  CollapseNeighbourhood neighbourhood_;
  LocalChange change_;  // that the removal changes which is looked at
  std::vector<Removal> due_;
  std::vector<Search> searches_;
  RingWalks<Search> walks_;
  std::vector<std::uint32_t> touched_;
};

}  // namespace vkmesh::detail
