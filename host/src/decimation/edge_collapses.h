// Decimation by collapsing edges: taken from a queue, judged, collapsed.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/mesh/handles.h>

#include "base/parallel.h"
#include "base/prefetch.h"
#include "decimation/collapse_neighbourhood.h"
#include "decimation/collapse_operator.h"
#include "decimation/cost/attribute_quadrics.h"
#include "decimation/cost/edge_batch.h"
#include "decimation/cost/placements.h"
#include "decimation/decimation_state.h"
#include "decimation/legality/criteria.h"
#include "decimation/legality/judge.h"
#include "decimation/legality/local_change.h"
#include "decimation/order/collapse_queues.h"
#include "decimation/order/edge_tags.h"
#include "decimation/order/pending_edges.h"
#include "decimation/parallel/partition.h"
#include "decimation/vertex_record.h"

namespace vkmesh::detail {

/// Edge collapses, the cheapest first.
///
/// Each edge has at most one live queue entry, that of the half-edge tagged kQueued; untagged entries are
/// stale and skipped. An edge whose collapse was illegal is parked, and comes back when a vertex next to it
/// has changed: nothing else can make it legal. With attributes costs rise and fall as they do without.
template <class Placement, class Queue, bool kAttributes = false>
class EdgeCollapses {
 public:
  /// What a thread works on by itself: all edges, or those of a partition of the surface.
  struct Share {
    /// `edges`: about how many the queue will hold.
    Share(DecimationState& all, std::size_t edges, Partition where = {})
        : state(all), partition(where), queue(all.mesh.half_edge_bound(), edges) {}

    DecimationState& state;
    Partition partition;
    Queue queue;
    std::uint32_t last = MonotoneQueue::kLast;  // bucket that is served
    /// Half-edges of edges on the interface, and vertices there whose parked edges come back: for the
    /// interface's share to take over.
    std::vector<std::uint32_t> forwarded, to_revive;
    /// What the square of a distance costs at least; 0 while points may move as they like.
    float cost_of_distance = 0;
    bool only_at_boundary = false;  // or at locked vertices

    /// Sets cost_of_distance by how many faces are left in all partitions: once they are few, points must not
    /// move far for what their quadrics say that costs. It changes only when half as many are left, so that
    /// an edge is not put off again and again.
    void watch(const DecimationState& all) {
      const std::size_t share = std::bit_floor(all.input_faces / std::max<std::size_t>(all.faces, 1));
      const double edge_weight = 2 * all.mean_weight * static_cast<double>(share);
      only_at_boundary = share < kFewLeft;
      const double farthest2 = only_at_boundary ? kFarthestAtBoundary2 : kFarthest2;
      cost_of_distance = share >= kFewAtBoundary ? static_cast<float>(edge_weight / farthest2) : 0.0f;
    }
    /// A 32nd of the faces, and a fourth at the boundary, where tips are cut off at next to no cost.
    static constexpr std::size_t kFewLeft = 32, kFewAtBoundary = 4;
    /// How far, in roots of the mean square distance that a cost stands for; squared.
    static constexpr double kFarthest2 = 1.75, kFarthestAtBoundary2 = 2.25;
  };

  explicit EdgeCollapses(CollapseMesh& mesh) : mesh_(mesh), vertices_(mesh.vertices), operator_(mesh) {}

  void work_on(Share& share) { share_ = &share; }

  /// About how many removals one step tries.
  static constexpr std::size_t kStep = Queue::kBatch;

  /// Calls prepare(face) for all faces on any threads, which returns a number for each of its half-edges, and
  /// then put(number, half-edge, cost) for one half-edge of each edge.
  template <class Prepare, class Put>
  void fill(Prepare&& prepare, Put&& put) {
    constexpr std::size_t kAhead = 64;
    const auto make = [this, &prepare](std::size_t begin, std::size_t end, First& block) {
      block.count = 0;
      share_->state.ask();
      if (share_->state.reached()) return;
      CollapseMesh::Face* const faces = &mesh_.face(0);
      const VertexRecord* const vertices = vertices_.data();
      std::uint32_t* const ids = block.ids.data();
      EdgeBatch::Ends* const ends = block.ends.data();
      std::uint8_t* const numbers = block.number.data();
      // Branchless: which faces are left is unpredictable.
      std::uint32_t* const alive = block.alive.data();
      std::size_t alive_count = 0, count = 0;
      for (auto f = static_cast<std::uint32_t>(begin); f < end; ++f) {
        prefetch_stream(&faces[f]);
        alive[alive_count] = f;
        alive_count += faces[f].alive() ? 1 : 0;
      }
      for (std::size_t k = 0; k < alive_count; ++k) {
        for (const std::uint32_t v : faces[alive[std::min(k + kAhead, alive_count - 1)]].origin)
          prefetch(&vertices[v]);
        const std::uint32_t f = alive[k];
        CollapseMesh::Face& face = faces[f];
        const std::array<std::uint8_t, 3> number = prepare(face);
        std::uint32_t tags = 0;
        for (std::uint32_t i = 0; i < 3; ++i) {
          const std::uint32_t h = 4 * f + i;
          const std::uint32_t first = h < face.twin[i] ? 1 : 0;  // half of them, unpredictable
          tags |= first << i;
          ids[count] = h;
          ends[count] = {face.origin[i], face.origin[i < 2 ? i + 1 : 0]};
          numbers[count] = number[i];
          count += first;
        }
        face.tags |= tags;
      }
      block.count = count;
      for (std::size_t i = 0; i < count; i += EdgeBatch::kSize) {
        const auto batch_ids = std::span(block.ids).subspan(i, std::min(EdgeBatch::kSize, count - i));
        evaluate(batch_ids, std::span(block.ends).subspan(i, batch_ids.size()), block.batch);
        rank(batch_ids, block.batch, block.change, &block.cost[i]);
      }
    };
    const auto finish = [&](std::size_t, std::size_t, First& block) {
      for (std::size_t i = 0; i < block.count; ++i) put(block.number[i], block.ids[i], block.cost[i]);
    };
    parallel_in_order<First>(mesh_.face_count(), kFirstFaces, make, finish);
  }

  /// Steps while anything is due by `last`, a bucket of the queue, and no limit is met.
  void run(std::uint32_t last) {
    share_->last = last;
    while (!share_->state.reached() && step()) share_->state.ask();
  }

  /// Takes over what another has forwarded.
  void take_over(Share& other) {
    for (const std::uint32_t h : other.forwarded) share_->queue.insert_now(h);
    for (const std::uint32_t v : other.to_revive)
      if (vertices_[v].alive() && vertices_[v].has(VertexRecord::kHasParked)) revive_at(v);
    other.forwarded.clear();
    other.to_revive.clear();
  }

  /// Takes a batch from the queue and does what is legal and due. False when nothing is left.
  bool step() {
    if (!share_->partition.is_bounded()) share_->watch(share_->state);
    pending_->count = share_->queue.take(pending_->ids, share_->last);
    if (pending_->count == 0) return false;
    pending_->fetch(mesh_);
    evaluate_pending();
    pending_->walk(mesh_);
    serve();
    return true;
  }

  /// Counts what blocks each edge that is left.
  void count_blocked() {
    for (std::uint32_t f = 0; f < mesh_.face_count() && !share_->state.reached(); ++f) {
      if (f % kFirstFaces == 0) share_->state.ask();
      for (std::uint32_t h = 4 * f; h < 4 * f + 3; ++h) {
        if (!mesh_.alive(h) || !mesh_.has_tag(h, kParked) ||
            (!mesh_.is_ghost(mesh_.twin(h)) && mesh_.twin(h) < h))
          continue;
        // Rounding differs from one half of the edge to the other, and it was one of them that was refused.
        Reason why = judge_alone(h);
        if (why == Reason::kNone) why = judge_alone(mesh_.twin(h));
        if (why == Reason::kLocked && share_->state.boundary_kept && mesh_.on_boundary(mesh_.origin(h)) &&
            mesh_.on_boundary(mesh_.target(h)))
          why = Reason::kBoundary;
        if constexpr (kAttributes)
          if (const Wedges& wedges = share_->state.attributes->wedges();
              why == Reason::kLocked && wedges.is_fixed(mesh_.origin(h)) && wedges.is_fixed(mesh_.target(h)))
            why = Reason::kSeam;
        ++share_->state.outcome.blocked[why];
      }
    }
  }

 private:
  using Operator = CollapseOperator<kAttributes>;

  static constexpr std::size_t kFirstFaces = 1 << 12;
  // Edges of so many faces, and from where to where they go.
  struct First {
    static constexpr std::size_t kMaxEdges = 3 * kFirstFaces + 1;  // one more is written
    std::vector<std::uint32_t> alive = std::vector<std::uint32_t>(kFirstFaces);
    std::vector<std::uint32_t> ids = std::vector<std::uint32_t>(kMaxEdges);
    std::vector<EdgeBatch::Ends> ends = std::vector<EdgeBatch::Ends>(kMaxEdges);
    std::vector<std::uint8_t> number = std::vector<std::uint8_t>(kMaxEdges);
    std::vector<float> cost = std::vector<float>(kMaxEdges);
    EdgeBatch batch;
    LocalChange change;
    std::size_t count = 0;
  };

  // The edges of these half-edges, into the batch.
  void evaluate(std::span<const std::uint32_t> edges) {
    std::array<EdgeBatch::Ends, EdgeBatch::kSize> ends;
    for (std::size_t i = 0; i < edges.size(); ++i) ends[i] = ends_of(mesh_.face(edges[i]), edges[i]);
    evaluate(edges, std::span(ends).first(edges.size()), batch_);
  }
  [[nodiscard]] static EdgeBatch::Ends ends_of(const CollapseMesh::Face& face, std::uint32_t h) {
    return {face.origin[h & 3u], face.origin[CollapseMesh::kNextCorner[h & 3u]]};
  }
  void evaluate(std::span<const std::uint32_t> edges, std::span<const EdgeBatch::Ends> ends,
                EdgeBatch& batch) const {
    batch.gather(vertices_.data(), ends);
    if constexpr (kAttributes && Placement::kAtEnds) {
      EndCosts end_costs;
      share_->state.attributes->add_to_ends(batch, edges, end_costs);
      place_at_end(batch, end_costs, edges.size());
      return;
    }
    if constexpr (kAttributes) share_->state.attributes->add_to(batch, edges);
    Placement::place(batch, edges.size());
  }

  /// The ranks of the edges of the batch.
  const float* ranks_of(std::span<const std::uint32_t> edges) {
    if constexpr (!Placement::kByCriteria) return batch_.cost.data();
    rank(edges, batch_, change_, ranks_.data());
    return ranks_.data();
  }

  /// Under which costs the queue holds the edges of a batch.
  void rank(std::span<const std::uint32_t> edges, const EdgeBatch& batch, LocalChange& change,
            float* ranks) const {
    if constexpr (Placement::kByCriteria) {
      for (std::size_t i = 0; i < edges.size(); ++i) {
        const VertexRecord &p = vertices_[mesh_.origin(edges[i])], &q = vertices_[mesh_.target(edges[i])];
        if (share_->state.criteria->ranks_by_faces())
          record_collapse(
              change, mesh_, edges[i],
              Operator::place_of(p, q, batch.end[i], {batch.x[0][i], batch.x[1][i], batch.x[2][i]}),
              kManyEdges);
        else
          record_length(change, mesh_, edges[i]);
        ranks[i] = share_->state.criteria->cost(batch.cost[i], p.weight + q.weight, change);
      }
    } else {
      std::copy_n(batch.cost.begin(), edges.size(), ranks);
    }
  }

  using Pending = PendingEdges<Queue::kBatch>;
  using Due = DueEdge;

  /// Tells those that are due from those that go back at what they cost now.
  void evaluate_pending() {
    Pending& b = *pending_;
    // Branchless: the conditions are unpredictable.
    std::size_t live = 0;
    std::array<EdgeBatch::Ends, Queue::kBatch> ends;
    const std::uint32_t interface = share_->partition.is_bounded() ? tag_mask(kAtInterface) : 0;
    const CollapseMesh::Face* const faces = mesh_.faces();
    for (const std::uint32_t h : std::span(b.ids).first(b.count)) {
      const CollapseMesh::Face& face = faces[h >> 2];
      if ((face.tags >> (h & 3u) & interface) != 0) [[unlikely]] {
        share_->forwarded.push_back(h);
        continue;
      }
      b.ids[live] = h;
      ends[live++] = ends_of(face, h);
    }
    const auto ids = std::span(b.ids).first(live);
    evaluate(ids, std::span(ends).first(live), batch_);
    const float* const ranks = ranks_of(ids);
    b.due_count = 0;
    std::array<std::uint8_t, Queue::kBatch> is_due, due, others;
    for (std::size_t i = 0; i < ids.size(); ++i) is_due[i] = share_->queue.is_due(ids[i], ranks[i]) ? 1 : 0;
    std::size_t other_count = 0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      due[b.due_count] = others[other_count] = static_cast<std::uint8_t>(i);
      b.due_count += is_due[i];
      other_count += 1u - is_due[i];
    }
    for (std::size_t i = 0; i < b.due_count; ++i) b.due[i] = due_of(due[i], ids[due[i]]);
    for (const std::uint8_t i : std::span(others).first(other_count)) share_->queue.insert(ids[i], ranks[i]);
  }

  [[nodiscard]] bool is_mine(std::uint32_t h) const {
    return !share_->partition.is_bounded() || !mesh_.has_tag(h, kAtInterface);
  }
  void enqueue_now(std::uint32_t h) {
    if (is_mine(h))
      share_->queue.insert_now(h);
    else
      share_->forwarded.push_back(h);
  }

  /// Tries the edges that are due, and puts those back that a limit keeps from their turn.
  void serve() {
    std::size_t i = 0;
    for (; i < pending_->due_count && !share_->state.reached(); ++i) attempt(i);
    for (; i < pending_->due_count; ++i)
      if (const std::uint32_t h = pending_->due[i].half_edge; mesh_.has_tag(h, kQueued)) enqueue_now(h);
    for (const std::uint32_t v : touched_) vertices_[v].source &= ~VertexRecord::kTouched;
    touched_.clear();
  }

  /// The edge of a lane of the batch.
  [[nodiscard]] Due due_of(std::size_t i, std::uint32_t half_edge) const {
    return {half_edge, batch_.cost[i], batch_.end[i], {batch_.x[0][i], batch_.x[1][i], batch_.x[2][i]}};
  }

  void attempt(std::size_t i) {
    const Due& due = pending_->due[i];
    const std::uint32_t h = due.half_edge;
    if (!mesh_.has_tag(h, kQueued)) return;
    const std::uint32_t p = mesh_.origin(h), q = mesh_.target(h);
    if (vertices_[p].has(VertexRecord::kTouched) || vertices_[q].has(VertexRecord::kTouched)) {
      share_->queue.insert_now(h);
      return;
    }
    const Reason reason = judge_edge(i, due, p, q);
    if (reason == Reason::kNone) {
      const std::optional<float> later = cost_of_drift(due, p, q);
      if (!later) return collapse(due, p, q);
      if (const std::optional<Due> end = at_end(i, p, q)) return collapse(*end, p, q);
      share_->queue.insert(h, *later);
    } else {
      ++share_->state.outcome.rejected[reason];
      mesh_.clear_tag(h, kQueued);
      set_parked(mesh_, h);
      vertices_[p].source |= VertexRecord::kHasParked;
      vertices_[q].source |= VertexRecord::kHasParked;
    }
  }

  /// Whether the collapse of the edge that was looked at last may move points too far.
  [[nodiscard]] bool watches_distance() const {
    return share_->cost_of_distance > 0 &&
           (!share_->only_at_boundary || (around().flags() & VertexRecord::kLocked) != 0);
  }
  /// Quadrics do not see tangential drift: a thin tip goes at next to no cost. So a legal collapse waits
  /// until the costs that are due allow for the distance between the faces before and after: under what it
  /// waits in the queue, if it does.
  [[nodiscard]] std::optional<float> cost_of_drift(const Due& due, std::uint32_t p, std::uint32_t q) {
    if (Placement::kByCriteria || !watches_distance()) return std::nullopt;
    const float allowed = std::max(due.cost, share_->queue.level()) / share_->cost_of_distance;
    const float distance2 = operator_.squared_distance(due, p, q, allowed);
    const float cost = distance2 * share_->cost_of_distance;
    if (!(distance2 > allowed) || share_->queue.is_due(due.half_edge, cost)) return std::nullopt;
    return cost;
  }
  /// The same collapse into an end of the edge, where that costs no more and need not wait: the corner of a
  /// thin sheet, which its short side holds so weakly that the best place is found only nearly.
  [[nodiscard]] std::optional<Due> at_end(std::size_t i, std::uint32_t p, std::uint32_t q) {
    const Due& due = pending_->due[i];
    if (kAttributes || Placement::kAtEnds || due.end != EdgeBatch::kFree) return std::nullopt;
    const Vector3 d = minus(vertices_[q].position, vertices_[p].position);
    const std::array<Due, 2> ends = {
        Due{due.half_edge, cost_at(p, q, {0.0f, 0.0f, 0.0f}, d), EdgeBatch::kAtP, {0.0f, 0.0f, 0.0f}},
        Due{due.half_edge, cost_at(p, q, d, d), EdgeBatch::kAtQ, d}};
    for (const Due& end : ends)
      if (end.cost <= due.cost && judge_edge(i, end, p, q) == Reason::kNone && !cost_of_drift(end, p, q))
        return end;
    return std::nullopt;
  }
  /// The cost of p and of q, which is at p + d, when both go to p + x.
  [[nodiscard]] float cost_at(std::uint32_t p, std::uint32_t q, const Vector3& x, const Vector3& d) const {
    return vertices_[p].quadric.value(x) + vertices_[q].quadric.value(minus(x, d));
  }

  [[nodiscard]] Reason judge_alone(std::uint32_t h) {
    evaluate(std::span(&h, 1));
    pending_->due[0] = due_of(0, h);
    pending_->walked[0].size = Pending::Ring::kTooLong;
    return judge_edge(0, pending_->due[0], mesh_.origin(h), mesh_.target(h));
  }

  /// The collapse of edge i of those that are due, as judge() takes it. It looks around when it comes to
  /// the link condition.
  struct Change : Operator::Change {
    EdgeCollapses& self;
    std::size_t i;

    [[nodiscard]] const DecimationState& state() const { return self.share_->state; }
    [[nodiscard]] bool is_locked() const { return this->due.end == EdgeBatch::kLocked; }
    [[nodiscard]] bool keeps_seams() const {
      if constexpr (kAttributes)
        return state().attributes->wedges().keeps_seams(self.mesh_, this->due.half_edge);
      return true;
    }
    [[nodiscard]] bool exceeds_error() const {
      return self.operator_.exceeds_error(state(), this->due, this->p, this->q);
    }
    [[nodiscard]] bool meets_link_condition() const {
      self.look_around(i);
      return Operator::Change::meets_link_condition();
    }
    [[nodiscard]] bool meets_criteria() const {
      return state().criteria == nullptr || !state().criteria->bounds() ||
             self.meets_criteria(this->due, this->p, this->q);
    }
  };
  [[nodiscard]] Reason judge_edge(std::size_t i, const Due& due, std::uint32_t p, std::uint32_t q) {
    return judge(Change{{{}, operator_, due, p, q, share_->state.limits.cos_deviation}, *this, i});
  }

  [[nodiscard]] bool meets_criteria(const Due& due, std::uint32_t p, std::uint32_t q) {
    record_collapse(change_, mesh_, due.half_edge,
                    Operator::place_of(vertices_[p], vertices_[q], due.end, due.x));
    const std::size_t at_p = around().ring_p().size() + 1, at_q = around().ring_q().size() + 1;
    change_.edges_before =
        std::max(at_p - (mesh_.on_boundary(p) ? 1 : 0), at_q - (mesh_.on_boundary(q) ? 1 : 0));
    change_.edges_after = at_p + at_q - 4 - (mesh_.on_boundary(p) || mesh_.on_boundary(q) ? 1 : 0);
    return share_->state.criteria->allow(change_);
  }

  /// Looks around an edge with the rings that were walked, or with new ones if a collapse of this batch was
  /// near.
  void look_around(std::size_t i) {
    const auto &at_p = pending_->walked[2 * i], &at_q = pending_->walked[2 * i + 1];
    if (at_p.is_whole() && at_q.is_whole() &&
        (operator_.look_around(at_p.part(0, at_p.size), at_q.part(0, at_q.size)).flags() &
         VertexRecord::kTouched) == 0)
      return;
    const std::uint32_t h = pending_->due[i].half_edge;
    ring_p_.gather(mesh_, h);
    ring_q_.gather(mesh_, mesh_.twin(h));
    operator_.look_around(ring_p_.ring(), ring_q_.ring());
  }
  [[nodiscard]] const CollapseNeighbourhood& around() const { return operator_.neighbourhood(); }

  void collapse(const Due& due, std::uint32_t p, std::uint32_t q) {
    DecimationState& state = share_->state;
    const typename Operator::Plan plan = operator_.plan(state, due, p, q);
    if constexpr (Placement::kMayFall == MayFall::kOfGone) {
      collect_moved(plan.half_edge);
      price_moved(vertices_[plan.gone], vertices_[plan.kept], due.cost);
    }
    if (state.criteria != nullptr && state.criteria->bounds()) state.criteria->keep(change_);
    erase_queued(plan.half_edge);
    erase_queued(mesh_.twin(plan.half_edge));
    const CollapseMesh::Collapsed collapsed = operator_.carry_out(state, due, plan, share_->queue.bucket());
    touched_.push_back(plan.kept);
    if (share_->partition.is_interface())
      share_->partition.merge(mesh_, plan.gone, plan.kept, plan.others.vertices);
    for (const auto& [g, its_twin] : collapsed.joined) join(g, its_twin);
    if constexpr (Placement::kMayFall == MayFall::kAround) refresh_around(plan.kept);
    if constexpr (Placement::kMayFall == MayFall::kOfGone) put_moved();
    revive(plan.kept);
  }

  // The half-edges of a face that goes.
  void erase_queued(std::uint32_t h) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t g = (h & ~3u) + i;
      if (mesh_.has_tag(g, kQueued)) share_->queue.erase(g);
    }
  }

  // Two edges have become one, of the half-edges g and t: one entry is to stand for it.
  void join(std::uint32_t g, std::uint32_t t) {
    const WasQueued was = join_tags(mesh_, g, t);
    if constexpr (Queue::kExact)
      if (was == WasQueued::kBoth) share_->queue.erase(t);
    if (was == WasQueued::kNone) enqueue_now(g);
  }

  void put(std::uint32_t h, float cost) {
    if (is_mine(h))
      share_->queue.insert(h, cost);
    else
      share_->forwarded.push_back(h);
  }

  /// An edge at a vertex that goes, by the half-edge that is queued for it, and the vertex at its other end.
  struct Moved {
    std::uint32_t half_edge, end;
    float cost;
    bool is_less;
  };

  // The edges at the origin of h that are queued and will stay.
  void collect_moved(std::uint32_t h) {
    const std::uint32_t t = mesh_.twin(h);
    moved_.clear();
    for (std::uint32_t out = mesh_.around_vertex(h); out != h; out = mesh_.around_vertex(out)) {
      const std::uint32_t in = mesh_.twin(out), id = mesh_.has_tag(out, kQueued) ? out : in;
      const bool stays = ((id ^ h) >> 2 != 0) & ((id ^ t) >> 2 != 0);  // its face does
      if (mesh_.has_tag(id, kQueued) && stays) moved_.push_back({id, mesh_.origin(in), 0, false});
    }
  }

  template <class F>
  void for_each_batch(std::span<Moved> moved, F&& f) {
    for (std::size_t i = 0; i < moved.size(); i += EdgeBatch::kSize)
      f(moved.subspan(i, std::min(EdgeBatch::kSize, moved.size() - i)));
  }
  void evaluate_moved(std::span<const Moved> moved) {
    std::array<std::uint32_t, EdgeBatch::kSize> ids;
    for (std::size_t i = 0; i < moved.size(); ++i) ids[i] = moved[i].half_edge;
    evaluate(std::span(ids).first(moved.size()));
  }

  // What they cost once `gone` has become `kept`, and whether that is less than they stand under in the
  // queue. With attributes that is not to be had before.
  void price_moved(const VertexRecord& gone, const VertexRecord& kept, float cost) {
    for_each_batch(moved_, [&](std::span<Moved> moved) {
      if constexpr (kAttributes) {
        evaluate_moved(moved);
      } else {
        std::array<std::uint32_t, EdgeBatch::kSize> ends;
        for (std::size_t i = 0; i < moved.size(); ++i) ends[i] = moved[i].end;
        batch_.gather_q(vertices_.data(), std::span(ends).first(moved.size()));
        find_moved_costs(batch_, gone, kept, cost, moved.size());
      }
      for (std::size_t i = 0; i < moved.size(); ++i) {
        moved[i].cost = batch_.cost[i];
        moved[i].is_less = batch_.falls[i] != 0;
      }
    });
  }

  void put_moved() {
    if constexpr (kAttributes)
      for_each_batch(moved_, [&](std::span<Moved> moved) {
        evaluate_moved(moved);
        for (std::size_t i = 0; i < moved.size(); ++i) {
          moved[i].is_less = batch_.cost[i] < moved[i].cost;
          moved[i].cost = batch_.cost[i];
        }
      });
    for (const Moved& edge : moved_)
      if (edge.is_less) put(edge.half_edge, edge.cost);
  }

  // The first `edges` edges at v cost something else now. A vertex that has absorbed another has the edges of
  // that one first.
  void refresh(std::uint32_t v, std::size_t edges) {
    std::uint32_t h = vertices_[v].leading;
    while (edges > 0) {
      std::array<std::uint32_t, EdgeBatch::kSize> ids;
      std::size_t count = 0;
      for (; edges > 0 && count < ids.size(); --edges) {
        const std::uint32_t t = mesh_.twin(h);
        if (mesh_.has_tag(h, kQueued) || mesh_.has_tag(t, kQueued))
          ids[count++] = mesh_.has_tag(h, kQueued) ? h : t;
        h = mesh_.around_vertex(h);
      }
      evaluate(std::span(ids).first(count));
      const float* const ranks = ranks_of(std::span(ids).first(count));
      for (std::size_t i = 0; i < count; ++i) put(ids[i], ranks[i]);
    }
  }

  // From so many edges at a vertex on, ranks are told by as many of its faces, and those of its edges alone
  // are told again that end where something has changed: all that all of them see would make a vertex of k
  // neighbours cost O(k^3).
  static constexpr std::size_t kManyEdges = 64;

  [[nodiscard]] std::size_t edges_at(std::uint32_t v, std::size_t most) const {
    std::size_t edges = 0;
    const std::uint32_t first = vertices_[v].leading;
    std::uint32_t out = first;
    do {
      ++edges;
      out = mesh_.around_vertex(out);
    } while (out != first && edges < most);
    return edges;
  }

  // All edges at v cost something else now; so do those at its neighbours if their faces count.
  void refresh_around(std::uint32_t v) {
    constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
    if (!share_->state.criteria->ranks_by_faces()) return refresh(v, edges_at(v, kAll));
    const std::uint32_t start = vertices_[v].leading;
    std::uint32_t h = start;
    bool many = false;
    do {
      if (const std::uint32_t r = mesh_.target(h); r != mesh_.apex()) {
        const std::size_t edges = edges_at(r, kManyEdges);
        if (edges < kManyEdges)
          refresh(r, edges);
        else
          many = true;
      }
      h = mesh_.around_vertex(h);
    } while (h != start);
    if (many) refresh(v, edges_at(v, kAll));
  }

  // Parked edges near v may have become legal.
  void revive(std::uint32_t v) {
    if ((around().flags() & VertexRecord::kHasParked) != 0)
      for (const auto& ring : {around().ring_p().vertices, around().ring_q().vertices})
        for (const std::uint32_t r : ring)
          if (vertices_[r].has(VertexRecord::kHasParked)) {
            if (!share_->partition.is_bounded() || share_->partition.holds(r))
              revive_at(r);
            else
              share_->to_revive.push_back(r);
          }
    if (vertices_[v].has(VertexRecord::kHasParked)) revive_at(v);
  }
  void revive_at(std::uint32_t v) {
    vertices_[v].source &= ~VertexRecord::kHasParked;
    const std::uint32_t start = vertices_[v].leading;
    std::uint32_t h = start;
    do {
      if (mesh_.has_tag(h, kParked)) {
        clear_parked(mesh_, h);
        mesh_.set_tag(h, kQueued);
        enqueue_now(h);
      }
      h = mesh_.around_vertex(h);
    } while (h != start);
  }

  CollapseMesh& mesh_;
  LargeArray<VertexRecord>& vertices_;
  Share* share_ = nullptr;
  Operator operator_;
  EdgeBatch batch_;
  EdgeBatch::Lanes ranks_;
  LocalChange change_;
  std::unique_ptr<Pending> pending_ = std::make_unique<Pending>();
  std::vector<std::uint32_t> touched_;
  LongRing ring_p_, ring_q_;
  std::vector<Moved> moved_;
};

}  // namespace vkmesh::detail
