#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <queue>
#include <random>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/math/vec.h>

#include "decimation/cost/edge_batch.h"
#include "decimation/decimation_state.h"
#include "decimation/order/monotone_queue.h"
#include "support/data.h"
#include "support/shapes.h"
#include "support/vectors.h"

namespace vkmesh {
namespace {

using detail::EdgeBatch;
using detail::VertexRecord;
using test::dot;

struct Plane {
  DVec3 normal, point;
  double weight;
};

double sum(const std::vector<Plane>& planes, const DVec3& x) {
  double total = 0;
  for (const Plane& plane : planes) {
    const double distance = dot(plane.normal, x - plane.point);
    total += plane.weight * distance * distance;
  }
  return total;
}

/// The quadric of these planes about a place, summed in double.
VertexRecord vertex_at(const DVec3& place, const std::vector<Plane>& planes) {
  std::array<double, 6> a{};
  std::array<double, 3> b{};
  double c = 0;
  for (const Plane& plane : planes) {
    const DVec3& n = plane.normal;
    const double offset = dot(n, place - plane.point), w = plane.weight;
    const std::array<double, 6> products = {n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z};
    for (std::size_t k = 0; k < 6; ++k) a[k] += w * products[k];
    for (int k = 0; k < 3; ++k) b[static_cast<std::size_t>(k)] += w * offset * n[k];
    c += w * offset * offset;
  }
  VertexRecord v{};
  for (int k = 0; k < 3; ++k) v.position[static_cast<std::size_t>(k)] = static_cast<float>(place[k]);
  for (std::size_t k = 0; k < 6; ++k) v.quadric.a[k] = static_cast<float>(a[k]);
  for (std::size_t k = 0; k < 3; ++k) v.quadric.b[k] = static_cast<float>(b[k]);
  v.quadric.c = static_cast<float>(c);
  return v;
}

}  // namespace

TEST_CASE("a monotone queue serves as std::priority_queue does with the same laziness", "[heap]") {
  using Entry = std::pair<std::uint32_t, std::uint32_t>;  // bucket, id
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    constexpr std::uint32_t kIds = 3000;
    const std::size_t at_once = seed % 3 == 0 ? 1 : 1 + random() % 128;
    // How often an id is found to cost more than it was put in under, and then how much.
    std::vector<std::vector<float>> costs(kIds);
    for (auto& rising : costs) {
      float cost =
          std::ldexp(1.0f + static_cast<float>(random() % 1000) / 1000, static_cast<int>(random() % 40) - 30);
      if (random() % 50 == 0) cost = 0;
      for (std::uint32_t i = 0; i <= random() % 4; ++i) {
        rising.push_back(cost);
        cost = cost * (1 + static_cast<float>(random() % 100) / 40) + (random() % 9 == 0 ? 1e-7f : 0.0f);
      }
    }
    MonotoneQueue queue(kIds);
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> reference;
    for (std::uint32_t id = 0; id < kIds; ++id) {
      queue.insert(id, costs[id][0]);
      reference.emplace(MonotoneQueue::bucket(costs[id][0]), id);
    }
    std::vector<Entry> served, expected;
    std::vector<std::size_t> risen(kIds, 0);
    std::vector<std::uint32_t> out(at_once);
    while (!queue.empty()) {
      const std::size_t count = queue.take(out);
      REQUIRE(count > 0);
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t id = out[i];
        const float cost = costs[id][std::min(++risen[id], costs[id].size() - 1)];
        if (queue.is_due(cost))
          served.emplace_back(MonotoneQueue::bucket(cost), id);
        else
          queue.insert(id, cost);
      }
    }
    CHECK(queue.take(out) == 0);
    std::fill(risen.begin(), risen.end(), std::size_t{0});
    while (!reference.empty()) {
      const auto [bucket, id] = reference.top();
      reference.pop();
      const std::uint32_t now = MonotoneQueue::bucket(costs[id][std::min(++risen[id], costs[id].size() - 1)]);
      if (now <= bucket)
        expected.emplace_back(now, id);
      else
        reference.emplace(now, id);
    }
    // The buckets come in the same order; within one the order is each queue's own.
    REQUIRE(served.size() == expected.size());
    CHECK(std::is_sorted(served.begin(), served.end(),
                         [](const Entry& a, const Entry& b) { return a.first < b.first; }));
    std::sort(served.begin(), served.end());
    std::sort(expected.begin(), expected.end());
    CHECK(served == expected);
  }
}

TEST_CASE("a monotone queue serves up to a bucket, and takes over another's ids where they were", "[heap]") {
  MonotoneQueue queue, other;
  CHECK(queue.first() == MonotoneQueue::kNone);
  for (std::uint32_t id = 0; id < 300; ++id) {
    queue.insert(id, std::ldexp(1.0f, static_cast<int>(id % 3)));
    other.insert(300 + id, std::ldexp(1.0f, static_cast<int>(id % 5) - 1));
  }
  CHECK(queue.first() == MonotoneQueue::bucket(1.0f));
  std::array<std::uint32_t, 64> out{};
  std::size_t served = 0;
  while (const std::size_t count = queue.take(out, MonotoneQueue::bucket(2.0f))) {
    for (std::size_t i = 0; i < count; ++i) CHECK(out[i] % 3 < 2);
    served += count;
  }
  CHECK(served == 200);
  CHECK(queue.floor() == MonotoneQueue::bucket(2.0f));
  CHECK(queue.first() == MonotoneQueue::bucket(4.0f));
  queue.absorb(other);
  CHECK(other.empty());
  CHECK(queue.size() == 400);
  // What costs less than the bucket that is served joins it.
  for (const auto& [priority, expected] :
       {std::pair(2.0f, 180u), std::pair(4.0f, 160u), std::pair(8.0f, 60u)}) {
    served = 0;
    while (const std::size_t count = queue.take(out, MonotoneQueue::bucket(priority))) served += count;
    CHECK(served == expected);
  }
}

TEST_CASE("a monotone queue hands out its ids, each where it was, and drops what nobody takes", "[heap]") {
  MonotoneQueue queue, even, third;
  for (std::uint32_t id = 0; id < 600; ++id) queue.insert(id, std::ldexp(1.0f, static_cast<int>(id % 7)));
  third.insert(1000, 8.0f);
  std::array<std::uint32_t, 1> one{};
  REQUIRE(third.take(one) == 1);  // which serves 8 now
  queue.distribute([&](std::uint32_t id) { return id % 2 == 0 ? &even : id % 3 == 0 ? &third : nullptr; });
  CHECK(queue.empty());
  CHECK(even.size() == 300);
  CHECK(third.size() == 100);
  std::array<std::uint32_t, 64> out{};
  while (const std::size_t count = even.take(out))
    for (std::size_t i = 0; i < count; ++i) {
      CHECK(out[i] % 2 == 0);
      CHECK(even.floor() == MonotoneQueue::bucket(std::ldexp(1.0f, static_cast<int>(out[i] % 7))));
    }
  while (const std::size_t count = third.take(out))
    for (std::size_t i = 0; i < count; ++i) {
      CHECK(out[i] % 6 == 3);
      CHECK(third.floor() ==
            MonotoneQueue::bucket(std::ldexp(1.0f, std::max(3, static_cast<int>(out[i] % 7)))));
    }
}

TEST_CASE("what costs too little for a monotone queue comes next, the last of a bucket first", "[heap]") {
  MonotoneQueue queue;
  std::array<std::uint32_t, 1> out{};
  for (std::uint32_t id = 0; id < 200; ++id) queue.insert(id, 8.0f);  // several chunks
  REQUIRE(queue.take(out) == 1);
  CHECK(out[0] == 199);
  queue.insert(500, 1.0f);
  queue.insert(501, -0.0f);
  queue.insert_now(502);
  CHECK(queue.size() == 202);
  for (const std::uint32_t id : {502u, 501u, 500u, 198u}) {
    REQUIRE(queue.take(out) == 1);
    CHECK(out[0] == id);
  }
  CHECK(queue.is_due(8.4f));
  CHECK_FALSE(queue.is_due(8.5f));  // the next sixteenth of the octave
}

TEST_CASE("quadric errors are sums over planes, and optimal places are least, by double precision",
          "[decimate]") {
  std::mt19937 random(5);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 - 0.5; };
  const auto direction = [&] {
    for (;;) {
      const DVec3 n(uniform(), uniform(), uniform());
      if (const double length = std::sqrt(dot(n, n)); length > 0.1) return n / length;
    }
  };
  for (const std::size_t count : {1u, 5u, 16u, 100u, 128u}) {
    EdgeBatch optimal;
    std::vector<VertexRecord> p(count), q(count);
    std::vector<std::vector<Plane>> planes(count);
    std::vector<DVec3> from(count);
    for (std::size_t i = 0; i < count; ++i) {
      // Places that float holds exactly.
      const auto place = [&] {
        return DVec3(Vec3(static_cast<float>(uniform()), static_cast<float>(uniform()),
                          static_cast<float>(uniform())));
      };
      const DVec3 a = place(), b = place();
      from[i] = a;
      for (int end = 0; end < 2; ++end) {
        std::vector<Plane> at;
        for (int k = 0; k < 5; ++k)
          at.push_back({direction(), (end == 0 ? a : b) + 0.1 * direction(), 0.1 + std::fabs(uniform())});
        (end == 0 ? p : q)[i] = vertex_at(end == 0 ? a : b, at);
        planes[i].insert(planes[i].end(), at.begin(), at.end());
      }
    }
    // In one array, out of order.
    std::vector<VertexRecord> vertices(2 * count);
    std::vector<EdgeBatch::Ends> ends(count);
    for (std::size_t i = 0; i < count; ++i)
      ends[i] = {static_cast<std::uint32_t>(count - 1 - i),
                 static_cast<std::uint32_t>(count + (i + 7) % count)};
    const auto gather = [&](EdgeBatch& batch) {
      for (std::size_t i = 0; i < count; ++i) {
        vertices[ends[i][0]] = p[i];
        vertices[ends[i][1]] = q[i];
      }
      batch.gather(vertices.data(), ends);
    };
    // Each of the ten planes has a weight below 0.6, and nothing is farther than 4 away: values below 100,
    // of some forty operations.
    constexpr double kRounding = 100 * 40.0 / (1 << 24);
    gather(optimal);
    detail::place_optimally(optimal, count);
    for (std::size_t i = 0; i < count; ++i) {
      const DVec3 x = from[i] + DVec3(optimal.x[0][i], optimal.x[1][i], optimal.x[2][i]);
      CHECK(std::fabs(sum(planes[i], x) - static_cast<double>(optimal.cost[i])) < kRounding);
      // The normal equations, by Cramer's rule.
      std::array<std::array<double, 4>, 3> m{};
      for (const Plane& plane : planes[i])
        for (int r = 0; r < 3; ++r) {
          for (int c = 0; c < 3; ++c)
            m[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] +=
                plane.weight * plane.normal[r] * plane.normal[c];
          m[static_cast<std::size_t>(r)][3] +=
              plane.weight * plane.normal[r] * dot(plane.normal, plane.point);
        }
      const auto determinant = [&](std::size_t a, std::size_t b, std::size_t c) {
        return m[0][a] * (m[1][b] * m[2][c] - m[1][c] * m[2][b]) -
               m[0][b] * (m[1][a] * m[2][c] - m[1][c] * m[2][a]) +
               m[0][c] * (m[1][a] * m[2][b] - m[1][b] * m[2][a]);
      };
      const double d = determinant(0, 1, 2);
      const DVec3 best(determinant(3, 1, 2) / d, determinant(0, 3, 2) / d, determinant(0, 1, 3) / d);
      const DVec3 edge = DVec3(q[i].position[0], q[i].position[1], q[i].position[2]) - from[i];
      const DVec3 away = best - (from[i] + 0.5 * edge);
      if (dot(away, away) > 3.9 * dot(edge, edge)) continue;  // too far to be taken
      CHECK(sum(planes[i], x) < sum(planes[i], best) + kRounding);
    }
    EdgeBatch end;
    gather(end);
    detail::place_at_end(end, count);
    for (std::size_t i = 0; i < count; ++i) {
      const DVec3 to(q[i].position[0], q[i].position[1], q[i].position[2]);
      const double at_p = sum(planes[i], from[i]), at_q = sum(planes[i], to);
      CHECK(std::fabs(std::min(at_p, at_q) - static_cast<double>(end.cost[i])) < kRounding);
      if (std::fabs(at_p - at_q) > kRounding)
        CHECK(end.end[i] == (at_p < at_q ? EdgeBatch::kAtP : EdgeBatch::kAtQ));
    }
    // Locked ends stay.
    for (std::size_t i = 0; i < count; ++i) {
      if (i % 2 == 0) p[i].source |= VertexRecord::kLocked;
      if (i % 3 == 0) q[i].source |= VertexRecord::kLocked;
    }
    gather(optimal);
    detail::place_optimally(optimal, count);
    for (std::size_t i = 0; i < count; ++i) {
      CHECK(optimal.end[i] == (i % 2 == 0 ? EdgeBatch::kAtP : 0) + (i % 3 == 0 ? EdgeBatch::kAtQ : 0));
      if (optimal.end[i] == EdgeBatch::kAtP)
        CHECK((optimal.x[0][i] == 0 && optimal.x[1][i] == 0 && optimal.x[2][i] == 0));
      if (optimal.end[i] == EdgeBatch::kAtQ) CHECK(optimal.x[0][i] == q[i].position[0] - p[i].position[0]);
    }
  }
}

TEST_CASE("what edges cost whose end moves, and which cost less than before, by double precision",
          "[decimate]") {
  std::mt19937 random(11);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 - 0.5; };
  // Places that float holds exactly.
  const auto place = [&] {
    return DVec3(
        Vec3(static_cast<float>(uniform()), static_cast<float>(uniform()), static_cast<float>(uniform())));
  };
  const auto planes_at = [&](const DVec3& at, int count, double weight) {
    std::vector<Plane> planes;
    for (int k = 0; k < count; ++k) {
      const DVec3 n = place() + DVec3(1e-3);
      planes.push_back({n / std::sqrt(dot(n, n)), at + 0.6 * place(), weight});
    }
    return planes;
  };
  constexpr double kRounding = 100 * 40.0 / (1 << 24);
  std::size_t less = 0, not_less = 0;
  for (const std::size_t count : {1u, 5u, 16u, 17u, 100u, 128u}) {
    const DVec3 at_p = place(), at_q = place();
    const double weight = count % 2 == 0 ? 0.05 : 0.5;  // the lighter, the more edges cost less
    const std::vector<Plane> of_p = planes_at(at_p, 3, weight), of_q = planes_at(at_q, 4, weight);
    const VertexRecord p = vertex_at(at_p, of_p), q = vertex_at(at_q, of_q);
    std::vector<DVec3> at_r(count);
    std::vector<std::vector<Plane>> of_r(count);
    std::vector<VertexRecord> r(count);
    for (std::size_t i = 0; i < count; ++i) {
      at_r[i] = place();
      of_r[i] = planes_at(at_r[i], 2, 0.6);
      r[i] = vertex_at(at_r[i], of_r[i]);
      if (i % 5 == 4) r[i].source |= VertexRecord::kLocked;
    }
    const double collapse = sum(of_p, at_q) + sum(of_q, at_q);
    EdgeBatch batch;
    std::vector<std::uint32_t> ends(count);
    std::iota(ends.rbegin(), ends.rend(), 0u);
    std::ranges::reverse(r);
    batch.gather_q(r.data(), ends);
    std::ranges::reverse(r);
    detail::find_moved_costs(batch, p, q, static_cast<float>(collapse), count);
    for (std::size_t i = 0; i < count; ++i) {
      const double before =
          std::min(sum(of_p, at_p) + sum(of_r[i], at_p), sum(of_p, at_r[i]) + sum(of_r[i], at_r[i]));
      const double now = collapse + sum(of_r[i], at_q);
      CHECK(std::fabs(now - static_cast<double>(batch.cost[i])) < kRounding);
      if (std::fabs(now - before) < kRounding) continue;
      CHECK(batch.falls[i] == (now < before && i % 5 != 4 ? 1 : 0));
      ++(now < before ? less : not_less);
    }
  }
  CHECK(less > 10);
  CHECK(not_less > 10);
}

}  // namespace vkmesh
