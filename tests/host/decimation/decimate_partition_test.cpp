#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <tbb/task_arena.h>

#include "decimation/cost/edge_batch.h"
#include "decimation/decimate_support.h"
#include "decimation/decimation_state.h"
#include "decimation/edge_collapses.h"
#include "decimation/order/collapse_queues.h"
#include "decimation/order/edge_tags.h"
#include "decimation/parallel/coarsen.h"
#include "decimation/parallel/partition.h"
#include "decimation/parallel/partitioned_collapses.h"
#include "decimation/setup/initial_quadrics.h"
#include "decimation/vertex_record.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

using detail::CollapseMesh;
using detail::kAtInterface;
using detail::kParked;
using detail::kQueued;
using detail::Partition;
using test::ring_of;

constexpr std::uint8_t kInner = Partition::kInner;

CollapseMesh mesh_of(const IndexedFaceSet& set) {
  return test::collapse_mesh_of(test::fitted(set));
}

/// What makes it safe that threads work on the partitions, by definition.
void check(const CollapseMesh& mesh, const std::vector<std::uint8_t>& labels) {
  for (std::uint32_t v = 0; v < mesh.apex(); ++v) {
    if (!mesh.vertices[v].alive() || (labels[v] & kInner) == 0) continue;
    for (const std::uint32_t r : ring_of(mesh, v))
      if (r != mesh.apex()) REQUIRE((labels[r] & ~kInner) == (labels[v] & ~kInner));
  }
  for (std::uint32_t h = 0; h < mesh.half_edge_bound(); ++h) {
    if (h % 4 == 3 || !mesh.alive(h)) continue;
    const std::uint32_t p = mesh.origin(h), q = mesh.target(h);
    if (p == mesh.apex() || q == mesh.apex()) continue;
    REQUIRE(mesh.has_tag(h, kAtInterface) == (((labels[p] & labels[q]) & kInner) == 0));
  }
}

bool link_condition(const CollapseMesh& mesh, std::uint32_t p, std::uint32_t q) {
  const auto at_p = ring_of(mesh, p), at_q = ring_of(mesh, q);
  const std::set<std::uint32_t> one(at_p.begin(), at_p.end()), other(at_q.begin(), at_q.end());
  return std::ranges::count_if(one, [&](std::uint32_t v) { return other.contains(v); }) == 2 &&
         at_p.size() + at_q.size() > 7;
}

/// Partitions of a surface and the interface between them, one after another on one thread.
template <class Placement>
class Partitions {
 public:
  explicit Partitions(const IndexedFaceSet& shape, std::size_t count) : mesh_(mesh_of(shape)) {
    detail::sum_quadrics(mesh_, {});
    limits_.cos_deviation = std::cos(1.3f);
    labels_ = detail::partition_kd(mesh_, count);
    for (std::size_t i = 0; i <= count; ++i)
      shares_.push_back(std::make_unique<Share>(
          state_, shape.face_count(),
          Partition(labels_, i < count ? static_cast<std::uint8_t>(i) : Partition::kInterface)));
    for (std::uint32_t h = 0; h < mesh_.half_edge_bound(); h += 4)
      detail::tag_interface(labels_, mesh_.face(h));
    worker_.work_on(*shares_.back());
    worker_.fill([&](CollapseMesh::Face& face) { return detail::tag_interface(labels_, face); },
                 [&](std::uint8_t partition, std::uint32_t h, float cost) {
                   shares_[partition == Partition::kInterface ? count : partition]->queue.insert(h, cost);
                 });
  }

  /// False when nothing is left. No run removes more than about `most` faces.
  bool round(std::size_t most) {
    constexpr std::uint32_t kOctaves = 32;
    std::uint32_t first = MonotoneQueue::kNone;
    for (const auto& share : shares_) first = std::min(first, share->queue.first());
    if (first == MonotoneQueue::kNone) return false;
    last_ = first + kOctaves;
    for (const auto& share : shares_) {
      worker_.work_on(*share);
      if (share == shares_.back())
        for (const auto& other : shares_) worker_.take_over(*other);
      limits_.faces = state_.faces - std::min(most, state_.faces);
      const std::vector<Known> before = known_outside(share->partition);
      worker_.run(last_);
      CHECK(known_outside(share->partition) == before);
    }
    return true;
  }

  /// What the next round relies on: each edge is parked, or one of its halves stands in a queue, and no
  /// higher than where it belongs now or the rounds have come to. Of a point of least error that is too far
  /// the cost may fall, which nobody looks after.
  void check_queues() {
    std::map<std::uint32_t, std::uint32_t> lowest;
    std::size_t foreign = 0;
    for (std::size_t partition = 0; partition < shares_.size(); ++partition) {
      detail::LazyQueue queue = shares_[partition]->queue;
      std::array<std::uint32_t, 64> ids;
      while (const std::size_t count = queue.take(ids))
        for (std::size_t i = 0; i < count; ++i) {
          const std::uint32_t h = ids[i];
          const bool inner = mesh_.alive(h) && mesh_.has_tag(h, kQueued) && !mesh_.has_tag(h, kAtInterface);
          foreign +=
              inner && partition + 1 < shares_.size() && (labels_[mesh_.origin(h)] & ~kInner) != partition;
          std::uint32_t& bucket = lowest.try_emplace(h, MonotoneQueue::kNone).first->second;
          bucket = std::min(bucket, queue.bucket());
        }
    }
    std::size_t twice = 0, nowhere = 0, too_high = 0;
    for (std::uint32_t h = 0; h < 4 * mesh_.face_count(); ++h) {
      if (h % 4 == 3 || !mesh_.alive(h)) continue;
      const std::uint32_t t = mesh_.twin(h);
      twice += mesh_.has_tag(h, kQueued) + mesh_.has_tag(t, kQueued) + mesh_.has_tag(h, kParked) != 1 ? 1 : 0;
      if (!mesh_.has_tag(h, kQueued)) continue;
      const auto found = lowest.find(h);
      if (found == lowest.end()) {
        ++nowhere;
        continue;
      }
      const std::array<detail::EdgeBatch::Ends, 1> ends = {{{mesh_.origin(h), mesh_.target(h)}}};
      batch_.gather(mesh_.vertices.data(), ends);
      Placement::place(batch_, 1);
      const std::uint32_t due = MonotoneQueue::bucket(batch_.cost[0]) + 1;  // the next one, by rounding
      if (Placement::kMayFall != detail::MayFall::kNone && found->second > std::max(due, last_)) ++too_high;
    }
    CHECK(twice == 0);
    CHECK(nowhere == 0);
    CHECK(too_high == 0);
    CHECK(foreign == 0);
  }

  /// Between rounds no edge that is parked could collapse.
  void check_parked() {
    worker_.work_on(*shares_.back());
    worker_.count_blocked();
    CHECK(state_.outcome.blocked[Reason::kNone] == 0);
  }

  [[nodiscard]] std::size_t collapses() const { return state_.outcome.collapses; }

 private:
  using Worker = detail::EdgeCollapses<Placement, detail::LazyQueue>;
  using Share = typename Worker::Share;

  /// What a partition may not change where it does not belong.
  using Known = std::pair<std::array<float, 4>, bool>;
  [[nodiscard]] std::vector<Known> known_outside(const Partition& partition) const {
    std::vector<Known> known;
    for (std::uint32_t v = 0; v < mesh_.apex() && partition.is_bounded(); ++v) {
      const detail::VertexRecord& vertex = mesh_.vertices[v];
      const auto& [x, y, z] = vertex.position;
      if (!partition.holds(v)) known.push_back({{x, y, z, vertex.weight}, vertex.alive()});
    }
    return known;
  }

  CollapseMesh mesh_;
  detail::Limits limits_;
  detail::DecimationState state_{mesh_, limits_, mesh_.face_count(), mesh_.apex(), false, {}};
  std::vector<std::uint8_t> labels_;
  std::vector<std::unique_ptr<Share>> shares_;  // the last is of the interface
  Worker worker_{mesh_};
  detail::EdgeBatch batch_;
  std::uint32_t last_ = 0;
};

template <class Placement>
void check_rounds(const IndexedFaceSet& shape) {
  for (const std::size_t most : {shape.face_count(), std::size_t{20}}) {
    Partitions<Placement> partitions(shape, 4);
    partitions.check_queues();
    while (partitions.round(most)) {
      partitions.check_queues();
      partitions.check_parked();
    }
    CHECK(partitions.collapses() > shape.points.size() / 2);
  }
}

/// Decimation in partitions as decimate() does it, of a mesh to be looked into.
struct Partitioned {
  Partitioned(const IndexedFaceSet& shape, std::size_t partition_faces, std::size_t to_faces)
      : mesh(mesh_of(shape)) {
    mesh.vertices[mesh.apex()].position.fill(std::numeric_limits<float>::quiet_NaN());
    detail::sum_quadrics(mesh, {10, 0, -1, 0, nullptr});
    limits.cos_deviation = std::cos(1.3f);
    limits.faces = to_faces;
    state.sizes.partition_faces = partition_faces;
  }

  CollapseMesh mesh;
  detail::Limits limits;
  detail::DecimationState state{mesh, limits, mesh.face_count(), mesh.apex(), false, {}};
};
using OptimalPartitioned = detail::PartitionedCollapses<detail::OptimalPlacement, detail::LazyQueue, false>;

}  // namespace

TEST_CASE("partitions see the corners that collapses brought to a face", "[decimate]") {
  // Columns of vertices: the first 17 are the first half of the vertices, and faces of one block have corners
  // in no other. Then the last of these columns collapses into the next one, along its edges from below.
  constexpr std::uint32_t kColumns = 34, kRows = 65;
  IndexedFaceSet strip;
  for (std::uint32_t x = 0; x < kColumns; ++x)
    for (std::uint32_t y = 0; y < kRows; ++y)
      strip.points.emplace_back(8 * (static_cast<float>(x) - 16.5f), static_cast<float>(y), 0);
  for (std::uint32_t x = 0; x + 1 < kColumns; ++x)
    for (std::uint32_t y = 0; y + 1 < kRows; ++y) {
      const std::uint32_t a = x * kRows + y, b = a + kRows;
      for (const std::uint32_t v : {a, b, b + 1, a, b + 1, a + 1}) strip.corners.push_back(v);
    }
  tbb::task_arena two(2);
  two.execute([&] {
    CollapseMesh mesh = mesh_of(strip);
    for (std::uint32_t y = 0; y < kRows; ++y) {
      const std::uint32_t p = 16 * kRows + y, q = p + kRows;
      std::uint32_t h = mesh.vertices[p].leading;
      while (mesh.target(h) != q) h = mesh.around_vertex(h);
      REQUIRE(link_condition(mesh, p, q));
      std::vector<std::uint32_t> others;
      for (std::uint32_t out = mesh.around_vertex(h); out != h; out = mesh.around_vertex(out))
        others.push_back(out);
      mesh.collapse(h, others);
    }
    const std::vector<std::uint8_t> labels = detail::partition_kd(mesh, 2);
    for (std::uint32_t h = 0; h < mesh.half_edge_bound(); h += 4)
      if (mesh.alive(h)) detail::tag_interface(labels, mesh.face(h));
    check(mesh, labels);
    CHECK(labels[15 * kRows] == 0);
    CHECK(labels[17 * kRows] == 1);
  });
}

TEST_CASE(
    "partitions of a surface are compact, of one size, and stay apart through collapses on the interface",
    "[decimate]") {
  const std::vector<IndexedFaceSet> shapes = {test::icosphere(3), test::torus(24, 14), test::grid(20, 22)};
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const IndexedFaceSet& shape = shapes[seed % shapes.size()];
    CollapseMesh mesh = mesh_of(shape);
    const std::size_t partitions = seed < 3 ? 4 : 8;
    std::vector<std::uint8_t> labels = detail::partition_kd(mesh, partitions);
    REQUIRE(labels.size() == shape.points.size() + 1);
    for (std::uint32_t h = 0; h < mesh.half_edge_bound(); h += 4) detail::tag_interface(labels, mesh.face(h));
    check(mesh, labels);
    std::vector<std::size_t> size(partitions);
    std::size_t interface = 0;
    for (std::uint32_t v = 0; v < mesh.apex(); ++v) {
      REQUIRE((labels[v] & ~kInner) < static_cast<int>(partitions));
      ++size[labels[v] & ~kInner];
      const auto ring = ring_of(mesh, v);
      const bool foreign = std::ranges::any_of(ring, [&](std::uint32_t r) {
        return r != mesh.apex() && (labels[r] & ~kInner) != (labels[v] & ~kInner);
      });
      REQUIRE(foreign == ((labels[v] & kInner) == 0));
      interface += foreign ? 1 : 0;
    }
    // As even as rows of equal coordinates allow; a compact partition of m vertices has about 4√m on its rim.
    const auto [least, most] = std::ranges::minmax(size);
    CHECK(3 * least > most);
    CHECK(interface < shape.points.size() * 7 / 10);

    Partition everywhere(labels, Partition::kInterface);
    std::mt19937 random(seed);
    std::size_t collapses = 0;
    for (int i = 0; i < 3000; ++i) {
      const auto h = static_cast<std::uint32_t>(random() % mesh.half_edge_bound());
      if (h % 4 == 3 || !mesh.alive(h) || !mesh.has_tag(h, kAtInterface)) continue;
      const std::uint32_t p = mesh.origin(h), q = mesh.target(h);
      if (p == mesh.apex() || q == mesh.apex() || !link_condition(mesh, p, q)) continue;
      const auto ring = ring_of(mesh, p);
      std::vector<std::uint32_t> others;
      for (std::uint32_t out = mesh.around_vertex(h); out != h; out = mesh.around_vertex(out))
        others.push_back(out);
      mesh.collapse(h, others);
      everywhere.merge(mesh, p, q, ring);
      if (++collapses % 8 == 0) check(mesh, labels);
    }
    CHECK(collapses > 50);
    check(mesh, labels);

    // Partitions become one again two by two, and what lay between them is no interface any more.
    for (std::size_t left = partitions; left > 1; left /= 2) {
      const std::vector<std::uint8_t> before = labels;
      std::vector<std::uint32_t> faces;
      for (std::uint32_t f = 0; f < mesh.half_edge_bound() / 4; ++f)
        if (mesh.alive(4 * f)) faces.push_back(f);
      detail::merge_pairs(mesh, labels, faces);
      check(mesh, labels);
      for (std::uint32_t v = 0; v < mesh.apex(); ++v) {
        if (!mesh.vertices[v].alive()) continue;
        REQUIRE((labels[v] & ~kInner) == (before[v] & ~kInner) / 2);
        const auto ring = ring_of(mesh, v);
        const bool foreign = std::ranges::any_of(ring, [&](std::uint32_t r) {
          return r != mesh.apex() && (labels[r] & ~kInner) != (labels[v] & ~kInner);
        });
        REQUIRE(foreign == ((labels[v] & kInner) == 0));
      }
    }
  }
}

TEST_CASE("no edge is lost or comes late between the partitions of a surface", "[decimate]") {
  for (IndexedFaceSet shape : {test::icosphere(3), test::torus(30, 16), test::grid(20, 22)}) {
    test::jitter(shape, 0.05f, 1);
    check_rounds<detail::OptimalPlacement>(shape);
    check_rounds<detail::EndPlacement>(shape);
  }
}

TEST_CASE("every edge is queued at first, once, by one of its halves", "[decimate]") {
  Partitioned all(test::grid(61, 80), 1, 0);  // of some blocks of faces
  detail::EdgeCollapses<detail::OptimalPlacement, detail::LazyQueue> worker(all.mesh);
  decltype(worker)::Share share(all.state, 0);
  worker.work_on(share);
  std::vector<int> prepared(all.mesh.face_count()), times(all.mesh.half_edge_bound());
  std::size_t misnumbered = 0;
  const auto number = [](std::uint32_t h) { return static_cast<std::uint8_t>(37 * h); };
  worker.fill(
      [&](const CollapseMesh::Face& face) {
        ++prepared[face.source];
        const std::uint32_t h = 4 * face.source;
        return std::array<std::uint8_t, 3>{number(h), number(h + 1), number(h + 2)};
      },
      [&](std::uint8_t given, std::uint32_t h, float) {
        ++times[h];
        misnumbered += given == number(h) ? 0 : 1;
      });
  CHECK(misnumbered == 0);
  CHECK(std::ranges::count(prepared, 1) == static_cast<std::ptrdiff_t>(prepared.size()));
  std::size_t wrong = 0;
  for (std::uint32_t h = 0; h < 4 * all.mesh.face_count(); ++h) {
    if (h % 4 == 3) continue;
    const std::uint32_t t = all.mesh.twin(h);
    wrong += times[h] + times[t] == 1 && all.mesh.has_tag(h, kQueued) == (times[h] == 1) ? 0 : 1;
  }
  CHECK(wrong == 0);
}

TEST_CASE("each half of an edge knows whether it is at the interface before partitions are at work",
          "[decimate]") {
  for (const IndexedFaceSet& shape : {test::grid(20, 22), test::torus(24, 14)}) {
    Partitioned all(shape, shape.face_count() / 4, 0);
    const std::vector<std::uint8_t> labels = detail::partition_kd(all.mesh, 4);
    OptimalPartitioned collapses(all.state);
    collapses.fill();
    check(all.mesh, labels);
    std::size_t interface = 0;
    for (std::uint32_t h = 0; h < 4 * all.mesh.face_count(); ++h)
      interface += h % 4 != 3 && all.mesh.has_tag(h, kAtInterface) ? 1 : 0;
    CHECK(interface > 100);
  }
}

TEST_CASE("what has gone before a surface is divided is on no interface", "[decimate]") {
  Partitioned all(test::grid(60, 22), 1, 300);
  all.state.sizes.range_faces = 1 << 20;
  detail::coarsen_if_far_from_target(all.state);
  REQUIRE(all.state.faces < all.mesh.face_count() * 3 / 4);
  const std::vector<std::uint8_t> labels = detail::partition_kd(all.mesh, 4);
  std::array<std::size_t, 4> sizes{};
  for (std::uint32_t v = 0; v < all.mesh.apex(); ++v) {
    if (!all.mesh.vertices[v].alive()) continue;
    const std::uint8_t partition = labels[v] & ~kInner;
    ++sizes.at(partition);
    const auto ring = ring_of(all.mesh, v);
    const bool inner = std::ranges::all_of(
        ring, [&](std::uint32_t r) { return r == all.mesh.apex() || (labels[r] & ~kInner) == partition; });
    CHECK(((labels[v] & kInner) != 0) == inner);
  }
  CHECK(3 * std::ranges::min(sizes) > std::ranges::max(sizes));
}

TEST_CASE("what was pruned is of no partition", "[decimate]") {
  const IndexedFaceSet shape = test::both(test::icosphere(3), test::grid(5, 4), {3.0f, 0.0f, 0.0f});
  IndexedFaceSet small = shape;
  for (std::size_t v = shape.points.size() - 30; v < shape.points.size(); ++v) small.points[v] *= 0.1f;
  DecimateOptions options;
  options.prune_size = Length::relative(0.25);
  options.target.ratio = 0.1;
  const auto done = detail::decimate_in_partitions({small.points, small.corners}, options);
  REQUIRE(done);
  REQUIRE(validate(done->mesh));
  CHECK(done->pruned_components == 1);
  CHECK(done->pruned_faces == 40);
  CHECK(done->mesh.face_count() == 132);
  for (std::size_t v = 0; v < small.points.size(); ++v)
    CHECK((done->vertex_map[v] == kInvalid) == (v + 30 >= small.points.size()));
}

TEST_CASE("partitions that become one again lose nothing", "[decimate]") {
  IndexedFaceSet half = test::icosphere(4);
  test::jitter(half, 0.05f, 1);
  const IndexedFaceSet shape = test::both(half, half, {3.0f, 0.0f, 0.0f});
  // So near the target that there is no round before.
  const std::size_t partition_faces = shape.face_count() / 2, to_faces = shape.face_count() - 300;
  Partitioned all(shape, partition_faces, to_faces);
  OptimalPartitioned collapses(all.state);
  collapses.fill();
  while (!all.state.reached()) REQUIRE(collapses.step());
  std::array<std::size_t, 2> gone{};
  for (std::uint32_t v = 0; v < all.mesh.apex(); ++v)
    gone[v < half.points.size() ? 0 : 1] += all.mesh.vertices[v].alive() ? 0 : 1;
  CHECK(gone[0] + gone[1] == 150);
  CHECK(std::min(gone[0], gone[1]) > 60);
}

TEST_CASE("a history of partitions has at any time done as much in each", "[decimate]") {
  IndexedFaceSet half = test::icosphere(4);
  test::jitter(half, 0.05f, 1);
  const IndexedFaceSet mesh = test::both(half, half, {3.0f, 0.0f, 0.0f});
  for (DecimateOptions options : test::ways()) {
    if (options.operation == DecimateOperation::kVertexRemoval) continue;  // of one partition
    options.keep_history = true;
    options.target.ratio = 0.2;
    const auto done = detail::decimate_in_partitions({mesh.points, mesh.corners}, options);
    REQUIRE(done);
    std::ptrdiff_t ahead = 0, most = 0;
    for (const Collapse<Vec3>& c : done->history) {
      ahead += c.kept < half.points.size() ? 1 : -1;
      most = std::max(most, std::abs(ahead));
    }
    CHECK(done->history.size() > mesh.points.size() / 2);
    CHECK(100 * most < 2 * static_cast<std::ptrdiff_t>(done->history.size()));
  }
}

}  // namespace vkmesh
