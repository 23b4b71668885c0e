#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <vkmesh/decimation/addressable_heap.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/decimation/monotone_queue.h>

#include "catching.h"
#include "decimation/collapse_mesh.h"
#include "decimation/edge_batch.h"
#include "decimation/spatial_order.h"

// Compiled once for each instruction set, chosen when the program starts. The bytes do not change: none of
// these sets brings fused multiply-add, and lanes do not mix. Sanitizers run before the choice can be made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define VKMESH_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define VKMESH_CLONES
#endif
namespace vkmesh {
namespace detail {
namespace {

// A lane of a batch: both quadrics, and the edge.
struct Lane {
  std::array<float, 6> pa, qa;
  std::array<float, 3> pb, qb, d;
  float pc, qc;
  std::int32_t end;
};

[[gnu::always_inline]] inline Lane lane_of(const EdgeBatch& batch, std::size_t i) {
  const auto& p = batch.p;
  const auto& q = batch.q;
  const auto locked = [](float source) {
    return static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(source) >> 28 & 1u);
  };
  return {{p[3][i], p[4][i], p[5][i], p[6][i], p[7][i], p[8][i]},
          {q[3][i], q[4][i], q[5][i], q[6][i], q[7][i], q[8][i]},
          {p[9][i], p[10][i], p[11][i]},
          {q[9][i], q[10][i], q[11][i]},
          {q[0][i] - p[0][i], q[1][i] - p[1][i], q[2][i] - p[2][i]},
          p[12][i],
          q[12][i],
          locked(p[15][i]) + 2 * locked(q[15][i])};
}

// Of the quadric (a, b, c) at (x, y, z); what rounding leaves below 0 is 0.
[[gnu::always_inline]] inline float value(const std::array<float, 6>& a, const std::array<float, 3>& b,
                                          float c, float x, float y, float z) {
  const float ax = a[0] * x + a[1] * y + a[2] * z;
  const float ay = a[1] * x + a[3] * y + a[4] * z;
  const float az = a[2] * x + a[4] * y + a[5] * z;
  const float sum = c + x * (ax + 2 * b[0]) + y * (ay + 2 * b[1]) + z * (az + 2 * b[2]);
  return sum > 0 ? sum : 0.0f;
}

[[gnu::always_inline]] inline float both(const Lane& lane, float x, float y, float z) {
  return value(lane.pa, lane.pb, lane.pc, x, y, z) +
         value(lane.qa, lane.qb, lane.qc, x - lane.d[0], y - lane.d[1], z - lane.d[2]);
}

}  // namespace

VKMESH_CLONES void place_optimally(EdgeBatch& batch, std::size_t count) {
  // Directions in which the quadric is flatter than this share of its steepest are left to the middle.
  constexpr float kFlat = 1.0f / (1 << 20);
  for (std::size_t first = 0; first < count; first += EdgeBatch::kBlock)
    for (std::size_t i = first; i < first + EdgeBatch::kBlock; ++i) {
      const Lane lane = lane_of(batch, i);
      const auto &pa = lane.pa, &qa = lane.qa;
      const auto &pb = lane.pb, &qb = lane.qb;
      const float dx = lane.d[0], dy = lane.d[1], dz = lane.d[2];
      const float mx = 0.5f * dx, my = 0.5f * dy, mz = 0.5f * dz;
      const float xx = pa[0] + qa[0], xy = pa[1] + qa[1], xz = pa[2] + qa[2];
      const float yy = pa[3] + qa[3], yz = pa[4] + qa[4], zz = pa[5] + qa[5];
      // Half the gradient in the middle, m from p and -m from q.
      const float gx = (pb[0] + qb[0]) + ((pa[0] - qa[0]) * mx + (pa[1] - qa[1]) * my + (pa[2] - qa[2]) * mz);
      const float gy = (pb[1] + qb[1]) + ((pa[1] - qa[1]) * mx + (pa[3] - qa[3]) * my + (pa[4] - qa[4]) * mz);
      const float gz = (pb[2] + qb[2]) + ((pa[2] - qa[2]) * mx + (pa[4] - qa[4]) * my + (pa[5] - qa[5]) * mz);
      // L D Lᵀ of A + εI, whose pivots are at least ε but for rounding.
      const float e = (xx + yy + zz) * kFlat + 1e-36f, least = 0.5f * e;
      const float d0 = xx + e, r0 = 1.0f / d0;
      const float l1 = xy * r0, l2 = xz * r0;
      const float p1 = (yy + e) - l1 * xy, d1 = p1 > least ? p1 : least, r1 = 1.0f / d1;
      const float u = yz - l2 * xy, l3 = u * r1;
      const float p2 = (zz + e) - l2 * xz - l3 * u, d2 = p2 > least ? p2 : least, r2 = 1.0f / d2;
      const auto solve = [&](float hx, float hy, float hz, float& tx, float& ty, float& tz) {
        const float w0 = -hx, w1 = -hy - l1 * w0, w2 = -hz - l2 * w0 - l3 * w1;
        tz = w2 * r2;
        ty = w1 * r1 - l3 * tz;
        tx = w0 * r0 - l1 * ty - l2 * tz;
      };
      float sx, sy, sz, tx, ty, tz;
      solve(gx, gy, gz, sx, sy, sz);
      // Once more for the rest, which takes back what ε has shortened of steep directions.
      solve(gx + (xx * sx + xy * sy + xz * sz), gy + (xy * sx + yy * sy + yz * sz),
            gz + (xz * sx + yz * sy + zz * sz), tx, ty, tz);
      sx += tx;
      sy += ty;
      sz += tz;
      // Farther from the middle than twice the edge no planes of its faces can lead in earnest.
      const bool near = sx * sx + sy * sy + sz * sz <= 4 * (dx * dx + dy * dy + dz * dz);
      sx = near ? sx : 0.0f;
      sy = near ? sy : 0.0f;
      sz = near ? sz : 0.0f;
      const bool free = lane.end == 0, at_p = lane.end == 1;
      const float x = free ? mx + sx : at_p ? 0.0f : dx;
      const float y = free ? my + sy : at_p ? 0.0f : dy;
      const float z = free ? mz + sz : at_p ? 0.0f : dz;
      batch.x[0][i] = x;
      batch.x[1][i] = y;
      batch.x[2][i] = z;
      batch.end[i] = lane.end;
      batch.cost[i] = both(lane, x, y, z);
    }
}

VKMESH_CLONES void place_in_middle(EdgeBatch& batch, std::size_t count) {
  for (std::size_t first = 0; first < count; first += EdgeBatch::kBlock)
    for (std::size_t i = first; i < first + EdgeBatch::kBlock; ++i) {
      const Lane lane = lane_of(batch, i);
      const float share = lane.end == 0 ? 0.5f : lane.end == 1 ? 0.0f : 1.0f;
      const float x = share * lane.d[0], y = share * lane.d[1], z = share * lane.d[2];
      batch.x[0][i] = x;
      batch.x[1][i] = y;
      batch.x[2][i] = z;
      batch.end[i] = lane.end;
      batch.cost[i] = both(lane, x, y, z);
    }
}

VKMESH_CLONES void place_at_end(EdgeBatch& batch, std::size_t count) {
  for (std::size_t first = 0; first < count; first += EdgeBatch::kBlock)
    for (std::size_t i = first; i < first + EdgeBatch::kBlock; ++i) {
      const Lane lane = lane_of(batch, i);
      const float dx = lane.d[0], dy = lane.d[1], dz = lane.d[2];
      const float at_p = both(lane, 0.0f, 0.0f, 0.0f), at_q = both(lane, dx, dy, dz);
      const bool q = lane.end == 0 ? at_q <= at_p : lane.end != 1;
      batch.x[0][i] = q ? dx : 0.0f;
      batch.x[1][i] = q ? dy : 0.0f;
      batch.x[2][i] = q ? dz : 0.0f;
      batch.end[i] = lane.end == 3 ? 3 : q ? 2 : 1;
      batch.cost[i] = q ? at_q : at_p;
    }
}

/// The faces around the ends p and q of an edge that remain when it collapses, and how they turn.
class FaceTurns {
 public:
  static constexpr std::size_t kBlock = 16;
  using Lanes = std::vector<float>;

  /// For this many corners: those around p in order, then those around q; consecutive ones span a face.
  void resize(std::size_t corners) {
    if (corners + kBlock <= use.size()) return;
    const std::size_t size = (corners / kBlock + 4) * kBlock;
    for (Lanes* lanes : {&px, &py, &pz, &side, &bx, &by, &bz, &ax, &ay, &az, &length2}) lanes->resize(size);
    use.resize(size);
  }

  Lanes px, py, pz;               // the corners, relative to p
  Lanes side;                     // 0 where the corner belongs to p, 1 to q
  std::vector<std::int32_t> use;  // 1 where corner k and k + 1 span a face that remains, else 0
  Lanes bx, by, bz;               // twice the area vector before
  Lanes ax, ay, az;  // the same after, over the squared sides; 0 where there is no area, or no face
  Lanes length2;     // of that, squared
};

/// A triangle of less area than this share of its squared sides has no reliable normal.
constexpr float kDegenerate = 1e-6f;
/// Cosine of the angle at which neighbours stand against each other.
constexpr float kAgainst = -0.5f;

struct Turned {
  std::int32_t broken = 0;    ///< Faces that turn too far or lose their area.
  std::int32_t had_none = 0;  ///< Faces without area that get one.
  std::int32_t against = 0;   ///< Consecutive faces whose normals stand against each other afterwards.
};

/// Fills the normals of the `faces` faces, whose third corner is at 0 (p) or d (q) before, at x afterwards.
VKMESH_CLONES Turned turn_faces(FaceTurns& t, std::size_t faces, const std::array<float, 3>& d,
                                const std::array<float, 3>& x, float cos_deviation) {
  constexpr std::size_t kBlock = FaceTurns::kBlock;
  const float* const px = t.px.data();
  const float* const py = t.py.data();
  const float* const pz = t.pz.data();
  const std::int32_t* const use = t.use.data();
  float* const __restrict bx = t.bx.data();
  float* const __restrict by = t.by.data();
  float* const __restrict bz = t.bz.data();
  float* const __restrict ax = t.ax.data();
  float* const __restrict ay = t.ay.data();
  float* const __restrict az = t.az.data();
  const float dx = d[0], dy = d[1], dz = d[2], x0 = x[0], x1 = x[1], x2 = x[2];
  float* const __restrict length2 = t.length2.data();
  const float square_cos = cos_deviation * std::fabs(cos_deviation);
  const float* const side = t.side.data();
  const auto padded = static_cast<std::int32_t>((faces + kBlock - 1) / kBlock * kBlock);
  Turned turned;
  std::int32_t broken = 0, none = 0, against = 0;
  for (std::int32_t k = 0; k < padded; ++k) {
    const float at_q = side[k];
    const float ox = at_q * dx, oy = at_q * dy, oz = at_q * dz;
    const float ux = px[k] - ox, uy = py[k] - oy, uz = pz[k] - oz;
    const float vx = px[k + 1] - ox, vy = py[k + 1] - oy, vz = pz[k + 1] - oz;
    const float nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    const float fx = px[k] - x0, fy = py[k] - x1, fz = pz[k] - x2;
    const float gx = px[k + 1] - x0, gy = py[k + 1] - x1, gz = pz[k + 1] - x2;
    const float mx = fy * gz - fz * gy, my = fz * gx - fx * gz, mz = fx * gy - fy * gx;
    // Over the squared sides, so that no square below leaves the range of a float. Neither roots nor
    // conditions: they would not be done in vector registers.
    const float before = 1.0f / ((ux * ux + uy * uy + uz * uz) + (vx * vx + vy * vy + vz * vz) + 1e-36f);
    const float after = 1.0f / ((fx * fx + fy * fy + fz * fz) + (gx * gx + gy * gy + gz * gz) + 1e-36f);
    const float b0 = nx * before, b1 = ny * before, b2 = nz * before;
    const float a0 = mx * after, a1 = my * after, a2 = mz * after;
    const float n2 = b0 * b0 + b1 * b1 + b2 * b2, m2 = a0 * a0 + a1 * a1 + a2 * a2;
    const float dot = b0 * a0 + b1 * a1 + b2 * a2;
    const std::int32_t used = use[k];
    const std::int32_t had = (n2 > kDegenerate * kDegenerate ? 1 : 0) * used;
    const std::int32_t has = (m2 > kDegenerate * kDegenerate ? 1 : 0) * used;
    const std::int32_t close = dot * std::fabs(dot) < square_cos * (n2 * m2) ? 0 : 1;
    broken += had - had * has * close;
    none += has - had * has;
    const auto keep = static_cast<float>(has);
    bx[k] = nx;
    by[k] = ny;
    bz[k] = nz;
    ax[k] = a0 * keep;
    ay[k] = a1 * keep;
    az[k] = a2 * keep;
    length2[k] = m2 * keep;
  }
  for (std::int32_t k = 0; k < padded; ++k) {
    const float dot = ax[k] * ax[k + 1] + ay[k] * ay[k + 1] + az[k] * az[k + 1];
    against += dot * std::fabs(dot) < kAgainst * std::fabs(kAgainst) * (length2[k] * length2[k + 1]) ? 1 : 0;
  }
  turned.broken = broken;
  turned.had_none = none;
  turned.against = against;
  return turned;
}

}  // namespace detail

namespace {

using detail::CollapseMesh;
using detail::CollapseVertex;
using detail::EdgeBatch;
using detail::prefetch;

constexpr std::size_t kBatchesBetweenReports = 64;

// Queues. Each holds half-edges, one of the two of an edge, under lower bounds of the edge's cost.

/// For costs that only rise.
class LazyQueue {
 public:
  static constexpr std::size_t kBatch = EdgeBatch::kSize;
  LazyQueue(std::size_t, std::size_t edges) : queue_(edges) {}
  void fill(std::uint32_t id, float cost) { queue_.insert(id, cost); }
  void start() {}
  void insert(std::uint32_t id, float cost) { queue_.insert(id, cost); }
  void insert_now(std::uint32_t id) { queue_.insert_now(id); }
  void erase(std::uint32_t) {}
  [[nodiscard]] bool is_due(std::uint32_t, float cost) const { return queue_.is_due(cost); }
  std::size_t take(std::span<std::uint32_t> out) { return queue_.take(out); }

 private:
  MonotoneQueue queue_;
};

/// For costs that may fall, and the exact order.
class ExactQueue {
 public:
  static constexpr std::size_t kBatch = 1;
  ExactQueue(std::size_t half_edges, std::size_t) : heap_(half_edges) {}
  void fill(std::uint32_t id, float cost) { heap_.append(id, cost); }
  void start() { heap_.heapify(); }
  void insert(std::uint32_t id, float cost) { heap_.set(id, cost); }
  void insert_now(std::uint32_t id) { heap_.set(id, -1.0f); }
  void erase(std::uint32_t id) { heap_.remove(id); }
  [[nodiscard]] bool is_due(std::uint32_t id, float cost) const {
    return heap_.empty() || cost < heap_.top_priority() || (cost == heap_.top_priority() && id < heap_.top());
  }
  std::size_t take(std::span<std::uint32_t> out) {
    if (heap_.empty()) return 0;
    out[0] = heap_.top();
    heap_.pop();
    return 1;
  }

 private:
  AddressableHeap<> heap_;
};

// Removals by quadric error: where the point goes, and what is known of the cost.

struct OptimalCollapse {
  static constexpr bool kMayFall = false;
  static void place(EdgeBatch& batch, std::size_t count) { detail::place_optimally(batch, count); }
};
struct MidpointCollapse {
  static constexpr bool kMayFall = true;
  static void place(EdgeBatch& batch, std::size_t count) { detail::place_in_middle(batch, count); }
};
/// An edge r–p that became r–q may cost less than it did, but no less than the collapse of p into q.
struct EndCollapse {
  static constexpr bool kMayFall = true;
  static void place(EdgeBatch& batch, std::size_t count) { detail::place_at_end(batch, count); }
};

/// Where the mesh was: local = (input - centre) · scale, the scale a power of two.
struct Frame {
  DVec3 centre{0.0};
  double scale = 1;
  double diagonal = 0;  // of the bounding box, in units of the input
};

template <class Point>
Result<Frame> frame_of(std::span<const Point> points, std::span<const std::uint32_t> corners) {
  DVec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const std::uint32_t c : corners)
    for (int k = 0; k < 3; ++k) {
      const double x = points[c][k];
      low[k] = std::min(low[k], x);
      high[k] = std::max(high[k], x);
    }
  Frame frame;
  if (corners.empty()) return frame;
  const DVec3 size = high - low;
  const double largest = std::max({size.x, size.y, size.z});
  if (!std::isfinite(largest))
    return fail(ErrorCode::kUnsuitable, "decimation needs a mesh of finite extent");
  for (int k = 0; k < 3; ++k) frame.centre[k] = low[k] + 0.5 * size[k];
  if (largest > 0) {
    int exponent = 0;
    std::frexp(largest, &exponent);
    exponent = std::clamp(exponent, -1000, 1000);
    frame.scale = std::ldexp(1.0, -exponent);
    const DVec3 s = size * frame.scale;
    frame.diagonal = std::sqrt(s.x * s.x + s.y * s.y + s.z * s.z) / frame.scale;
  }
  return frame;
}

enum class Legality { kLegal, kLink, kFoldOver, kError, kLocked };

struct Limits {
  std::size_t faces = 0, vertices = 0;
  double error2 = std::numeric_limits<double>::infinity();  // mean squared distance, local units
  double seconds = std::numeric_limits<double>::infinity();
  float cos_deviation = 0;
};

struct Event {
  std::uint32_t kept, removed;
  std::array<float, 3> position;
  bool moved;  // from where the input has it
  std::array<std::uint32_t, 2> faces;
};

struct Outcome {
  DecimateStop stop = DecimateStop::kTargetReached;
  double error2 = 0;
  std::size_t collapses = 0;
  std::array<std::size_t, 5> rejected{};  // by Legality
  std::vector<Event> events;
};

/// One run: takes the cheapest edge, collapses it if that is legal, until a limit is met.
///
/// Each edge stands in the queue at most once in earnest, by the half-edge that is tagged as queued; what the
/// queue serves without the tag is stale. An edge whose collapse was found illegal is parked, and comes back
/// when a vertex next to it has changed: nothing else can make it legal.
template <class Removal, class Queue>
class Decimation {
 public:
  Decimation(CollapseMesh& mesh, const Limits& limits, std::size_t faces, std::size_t vertices,
             bool keep_events)
      : mesh_(mesh),
        vertices_(mesh.vertices),
        limits_(limits),
        keep_events_(keep_events),
        queue_(mesh.half_edge_bound(), 3 * mesh.face_count() / 2 + 1),
        faces_(faces),
        left_(vertices) {}

  Result<Outcome> run(const Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    if (!reached()) fill();
    const std::size_t first_faces = faces_, first_vertices = left_;
    std::array<std::uint32_t, Queue::kBatch> taken{};
    std::size_t batches = 0;
    bool exhausted = false;
    while (!reached()) {
      if (batches++ % (kBatchesBetweenReports * EdgeBatch::kSize / Queue::kBatch) == 0) {
        if (progress) {
          const auto share = [](std::size_t first, std::size_t now, std::size_t last) {
            return first <= last ? 1.0 : static_cast<double>(first - now) / static_cast<double>(first - last);
          };
          const double done = std::max(share(first_faces, faces_, limits_.faces),
                                       share(first_vertices, left_, limits_.vertices));
          if (!progress(std::min(done, 1.0)))
            return fail(ErrorCode::kInterrupted, "decimation was cancelled");
        }
        if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() >=
            limits_.seconds) {
          outcome_.stop = DecimateStop::kTimeLimit;
          break;
        }
      }
      const std::size_t count = queue_.take(taken);
      if (count == 0) {
        exhausted = true;
        break;
      }
      serve(std::span(taken).first(count));
    }
    if (exhausted)
      outcome_.stop = held_by_error() ? DecimateStop::kErrorBound : DecimateStop::kNoLegalCollapse;
    if (progress && !progress(1.0)) return fail(ErrorCode::kInterrupted, "decimation was cancelled");
    return std::move(outcome_);
  }

 private:
  [[nodiscard]] bool reached() const { return faces_ <= limits_.faces || left_ <= limits_.vertices; }

  // The edges of these half-edges, into the batch.
  void evaluate(std::span<const std::uint32_t> edges) {
    batch_.gather(edges.size(), [&](std::size_t i) {
      const std::uint32_t h = edges[i];
      return std::pair(&vertices_[mesh_.origin(h)], &vertices_[mesh_.target(h)]);
    });
    Removal::place(batch_, edges.size());
  }

  // All edges with their costs.
  void fill() {
    std::array<std::uint32_t, EdgeBatch::kSize + 1> ids{};
    std::size_t count = 0;
    const auto flush = [&] {
      evaluate(std::span(ids).first(count));
      for (std::size_t i = 0; i < count; ++i) queue_.fill(ids[i], batch_.cost[i]);
      count = 0;
    };
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f)
      for (std::uint32_t h = 4 * f; h < 4 * f + 3; ++h) {
        const bool first = h < mesh_.twin(h);  // half of them, in no order that could be foretold
        mesh_.face(h).tags |= static_cast<std::uint32_t>(first) << (h & 3u);
        ids[count] = h;
        count += first ? 1 : 0;
        if (count == EdgeBatch::kSize) flush();
      }
    flush();
    queue_.start();
  }

  // What follows happens to all edges of the batch before the next thing does: what one waits for from
  // memory comes while the others are looked at.
  void serve(std::span<const std::uint32_t> taken) {
    for (const std::uint32_t h : taken) prefetch(&mesh_.face(h));
    std::array<std::uint32_t, Queue::kBatch> ids;
    std::size_t count = 0;
    for (const std::uint32_t h : taken) {
      if (!mesh_.alive(h) || !mesh_.queued(h)) continue;
      prefetch(&vertices_[mesh_.origin(h)]);
      prefetch(&vertices_[mesh_.target(h)]);
      ids[count++] = h;
    }
    evaluate(std::span(ids).first(count));
    std::size_t due = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (queue_.is_due(ids[i], batch_.cost[i])) {
        due_[due++] = {
            ids[i], batch_.cost[i], batch_.end[i], {batch_.x[0][i], batch_.x[1][i], batch_.x[2][i]}};
      } else {
        queue_.insert(ids[i], batch_.cost[i]);
      }
    }
    if (due > 1) fetch_rings(due);
    for (std::size_t i = 0; i < due && !reached(); ++i) attempt(due_[i]);
    for (const std::uint32_t v : touched_) vertices_[v].source &= ~CollapseVertex::kTouched;
    touched_.clear();
  }

  struct Due {
    std::uint32_t half_edge;
    float cost;
    std::int32_t end;
    std::array<float, 3> x;
  };

  // Walks around the ends of all due edges, one step of each in turn, to have their records at hand.
  // Inlined by force: a function that only prefetches has no effect in the eyes of g++ 12, which drops the
  // call.
  [[gnu::always_inline]] void fetch_rings(std::size_t due) {
    constexpr int kSteps = 9;
    std::array<std::uint32_t, 2 * Queue::kBatch> at, start;
    std::size_t walks = 0;
    for (std::size_t i = 0; i < due; ++i) {
      const std::uint32_t h = due_[i].half_edge, t = mesh_.twin(h);
      prefetch(&mesh_.face(t));
      start[walks] = h;
      at[walks++] = h;
      start[walks] = t;
      at[walks++] = t;
    }
    for (int step = 0; step < kSteps; ++step) {
      std::size_t left = 0;
      for (std::size_t i = 0; i < walks; ++i) {
        const std::uint32_t h = at[i], before = CollapseMesh::previous(h), out = mesh_.twin(before);
        prefetch(&vertices_[mesh_.origin(before)]);
        if (out == start[i]) continue;
        prefetch(&mesh_.face(out));
        at[left] = out;
        start[left++] = start[i];
      }
      walks = left;
    }
  }

  void attempt(const Due& due) {
    const std::uint32_t h = due.half_edge;
    if (!mesh_.alive(h) || !mesh_.queued(h)) return;
    const std::uint32_t p = mesh_.origin(h), q = mesh_.target(h);
    if (vertices_[p].has(CollapseVertex::kTouched) || vertices_[q].has(CollapseVertex::kTouched)) {
      queue_.insert_now(h);
      return;
    }
    const Legality legality = judge(due, p, q);
    if (legality == Legality::kLegal) {
      collapse(due, p, q);
    } else {
      ++outcome_.rejected[static_cast<std::size_t>(legality)];
      mesh_.clear_queued(h);
      mesh_.set_parked(h);
      vertices_[p].source |= CollapseVertex::kHasParked;
      vertices_[q].source |= CollapseVertex::kHasParked;
    }
  }

  /// The neighbours of a vertex but one, counter-clockwise.
  struct Ring {
    std::vector<std::uint32_t> vertex;  // the first `count` are meant
    std::size_t count = 0;
    bool has_apex = false;

    [[nodiscard]] std::size_t size() const { return count; }
    [[nodiscard]] std::span<const std::uint32_t> all() const { return {vertex.data(), count}; }
    [[nodiscard]] std::span<const std::uint32_t> inner() const { return {vertex.data() + 1, count - 2}; }
  };
  /// Of the origin of h, from beyond its target.
  void collect_ring(std::uint32_t h, Ring& ring) const {
    std::size_t count = 0;
    bool has_apex = false;
    for (std::uint32_t out = mesh_.around_vertex(h); out != h; out = mesh_.around_vertex(out)) {
      if (count == ring.vertex.size()) ring.vertex.resize(2 * count + 16);
      const std::uint32_t v = mesh_.target(out);
      has_apex |= v == mesh_.apex();
      ring.vertex[count++] = v;
    }
    ring.count = count;
    ring.has_apex = has_apex;
  }

  [[nodiscard]] Legality judge(const Due& due, std::uint32_t p, std::uint32_t q) {
    if (due.end == 3) return Legality::kLocked;
    const double weight = static_cast<double>(vertices_[p].weight) + static_cast<double>(vertices_[q].weight);
    if (static_cast<double>(due.cost) > limits_.error2 * weight) return Legality::kError;
    collect_ring(due.half_edge, ring_p_);
    collect_ring(mesh_.twin(due.half_edge), ring_q_);
    if (!link_condition(q)) return Legality::kLink;
    return folds_over(due, p, q) ? Legality::kFoldOver : Legality::kLegal;
  }

  /// p and q share two neighbours, those across the edge's faces, and the four are no tetrahedron. Each ring
  /// starts with one of the two and ends with the other.
  [[nodiscard]] bool link_condition(std::uint32_t q) {
    if (ring_p_.all().front() == ring_p_.all().back()) return false;
    if (ring_p_.size() == 2 && ring_q_.size() == 2) return false;
    const auto inner_p = ring_p_.inner(), inner_q = ring_q_.inner();
    std::uint64_t seen = 0;  // a set of hashes: most rings need no second look
    const auto bit = [](std::uint32_t v) { return std::uint64_t{1} << (v * 0x9e3779b1u >> 26); };
    for (const std::uint32_t v : inner_p) seen |= bit(v);
    const auto in_p = [&](std::uint32_t v) {
      return (seen & bit(v)) != 0 && std::find(inner_p.begin(), inner_p.end(), v) != inner_p.end();
    };
    if (in_p(q)) return false;  // two edges between p and q
    if (inner_p.size() <= 64) return std::none_of(inner_q.begin(), inner_q.end(), in_p);
    sorted_.assign(inner_p.begin(), inner_p.end());
    std::sort(sorted_.begin(), sorted_.end());
    return std::none_of(inner_q.begin(), inner_q.end(), [&](std::uint32_t v) {
      return std::binary_search(sorted_.begin(), sorted_.end(), v);
    });
  }

  [[nodiscard]] bool folds_over(const Due& due, std::uint32_t p, std::uint32_t q) {
    const std::array<float, 3>&at = vertices_[p].position, &to = vertices_[q].position;
    const std::array<float, 3> d = {to[0] - at[0], to[1] - at[1], to[2] - at[2]};
    const std::size_t np = ring_p_.size(), all = np + ring_q_.size();
    turns_.resize(all);
    std::size_t k = 0;
    for (const Ring* ring : {&ring_p_, &ring_q_}) {
      for (std::size_t i = 0; i < ring->size(); ++i, ++k) {
        const std::uint32_t v = ring->vertex[i];
        const std::array<float, 3>& x = vertices_[v].position;
        turns_.px[k] = x[0] - at[0];
        turns_.py[k] = x[1] - at[1];
        turns_.pz[k] = x[2] - at[2];
        turns_.side[k] = ring == &ring_p_ ? 0.0f : 1.0f;
        turns_.use[k] = 1;
      }
      turns_.use[k - 1] = 0;  // between the rings, and behind the last
    }
    // The ghosts have no shape.
    if (ring_p_.has_apex || ring_q_.has_apex) {
      k = 0;
      for (const Ring* ring : {&ring_p_, &ring_q_})
        for (std::size_t i = 0; i < ring->size(); ++i, ++k)
          if (ring->vertex[i] == mesh_.apex()) {
            turns_.use[k] = 0;
            if (i > 0) turns_.use[k - 1] = 0;
          }
    }
    const std::size_t faces = all - 1;
    const std::size_t padded =
        (faces + detail::FaceTurns::kBlock) / detail::FaceTurns::kBlock * detail::FaceTurns::kBlock;
    for (k = all; k < padded; ++k) turns_.use[k] = 0;
    const detail::Turned turned = detail::turn_faces(turns_, faces, d, due.x, limits_.cos_deviation);
    if (turned.broken > 0) return true;
    if (turned.had_none > 0 && disagrees(faces)) return true;
    // Around p from one side of the edge to the other, then around q back: the faces np - 2 and np meet, and
    // the last and the first do.
    const float seam = np < faces ? std::min(cosine_after(np - 2, np), cosine_after(faces - 1, 0)) : 1.0f;
    return (turned.against > 0 || seam < detail::kAgainst) && more_against(faces, seam);
  }

  /// Whether a face that had no area and has one now looks against the others.
  [[nodiscard]] bool disagrees(std::size_t faces) const {
    float x = 0, y = 0, z = 0;
    for (std::size_t k = 0; k < faces; ++k) {
      const auto use = static_cast<float>(turns_.use[k]);
      x += use * turns_.bx[k];
      y += use * turns_.by[k];
      z += use * turns_.bz[k];
    }
    for (std::size_t k = 0; k < faces; ++k)
      if (turns_.use[k] != 0 && x * turns_.ax[k] + y * turns_.ay[k] + z * turns_.az[k] < 0) return true;
    return false;
  }

  /// Of the angle between two faces; 1 where one has no normal.
  [[nodiscard]] float cosine_after(std::size_t i, std::size_t j) const {
    const auto& t = turns_;
    const float n = std::sqrt(t.length2[i] * t.length2[j]);
    return n > 0 ? (t.ax[i] * t.ax[j] + t.ay[i] * t.ay[j] + t.az[i] * t.az[j]) / n : 1.0f;
  }
  [[nodiscard]] float cosine_before(std::size_t i, std::size_t j) const {
    const auto& t = turns_;
    if (t.use[i] == 0 || t.use[j] == 0) return 1.0f;
    const auto length = [&](std::size_t k) {
      return std::sqrt(t.bx[k] * t.bx[k] + t.by[k] * t.by[k] + t.bz[k] * t.bz[k]);
    };
    const float n = length(i) * length(j);
    return n > 0 ? (t.bx[i] * t.bx[j] + t.by[i] * t.by[j] + t.bz[i] * t.bz[j]) / n : 1.0f;
  }

  /// Whether two neighbours about the kept vertex stand more against each other than any of the faces that
  /// remain did before.
  [[nodiscard]] bool more_against(std::size_t faces, float seam) const {
    float after = seam, before = 1;
    for (std::size_t k = 0; k + 1 < faces; ++k) {
      after = std::min(after, cosine_after(k, k + 1));
      before = std::min(before, cosine_before(k, k + 1));
    }
    return after < before;
  }

  void collapse(const Due& due, std::uint32_t p, std::uint32_t q) {
    std::uint32_t h = due.half_edge;
    CollapseVertex &vp = vertices_[p], &vq = vertices_[q];
    std::array<float, 3> place;
    if (due.end == 0) {
      for (std::size_t k = 0; k < 3; ++k) place[k] = vp.position[k] + due.x[k];
    } else {
      place = due.end == 1 ? vp.position : vq.position;
    }
    // Which of the two goes: what was chosen; else that of fewer neighbours, which is less work.
    const bool keep_p =
        due.end == 0 ? ring_p_.size() > ring_q_.size() ||
                           (ring_p_.size() == ring_q_.size() && (vp.source & CollapseVertex::kSourceMask) <
                                                                    (vq.source & CollapseVertex::kSourceMask))
                     : due.end == 1;
    if (keep_p) h = mesh_.twin(h);
    CollapseVertex &kept = keep_p ? vp : vq, &gone = keep_p ? vq : vp;
    const std::uint32_t q_now = keep_p ? p : q;

    std::array<float, 3> dk, dg;
    for (std::size_t k = 0; k < 3; ++k) {
      dk[k] = place[k] - kept.position[k];
      dg[k] = place[k] - gone.position[k];
    }
    shift(kept, dk);
    shift(gone, dg);
    for (std::size_t k = 0; k < 6; ++k) kept.a[k] += gone.a[k];
    for (std::size_t k = 0; k < 3; ++k) kept.b[k] += gone.b[k];
    kept.c += gone.c;
    kept.weight += gone.weight;
    if (place != kept.position) kept.source |= CollapseVertex::kMoved;
    kept.position = place;
    kept.source |= CollapseVertex::kTouched | (gone.source & CollapseVertex::kHasParked);
    touched_.push_back(q_now);

    const std::uint32_t t = mesh_.twin(h);
    const CollapseMesh::Face &one = mesh_.face(h), &other = mesh_.face(t);
    if (keep_events_)
      outcome_.events.push_back({kept.source & CollapseVertex::kSourceMask,
                                 gone.source & CollapseVertex::kSourceMask,
                                 place,
                                 kept.has(CollapseVertex::kMoved),
                                 {one.source, other.source}});
    erase_queued(h);
    erase_queued(t);
    const std::uint32_t to_a = mesh_.twin(CollapseMesh::previous(h)),
                        from_a = mesh_.twin(CollapseMesh::next(h));
    const std::uint32_t to_b = mesh_.twin(CollapseMesh::previous(t)),
                        from_b = mesh_.twin(CollapseMesh::next(t));
    faces_ -= mesh_.collapse(h);
    --left_;
    ++outcome_.collapses;
    if (kept.weight > 0)
      outcome_.error2 =
          std::max(outcome_.error2, static_cast<double>(due.cost) / static_cast<double>(kept.weight));
    join(to_a, from_a);
    join(to_b, from_b);
    if constexpr (Removal::kMayFall) refresh(q_now);
    revive(q_now);
  }

  // Moves the point about which the vertex' quadric is expressed.
  static void shift(CollapseVertex& v, const std::array<float, 3>& d) {
    const auto& a = v.a;
    const std::array<float, 3> ad = {a[0] * d[0] + a[1] * d[1] + a[2] * d[2],
                                     a[1] * d[0] + a[3] * d[1] + a[4] * d[2],
                                     a[2] * d[0] + a[4] * d[1] + a[5] * d[2]};
    const float c =
        v.c + d[0] * (ad[0] + 2 * v.b[0]) + d[1] * (ad[1] + 2 * v.b[1]) + d[2] * (ad[2] + 2 * v.b[2]);
    v.c = c > 0 ? c : 0.0f;
    for (std::size_t k = 0; k < 3; ++k) v.b[k] += ad[k];
  }

  // The half-edges of a face that goes.
  void erase_queued(std::uint32_t h) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t g = (h & ~3u) + i;
      if (mesh_.queued(g)) queue_.erase(g);
    }
  }

  // Two edges have become one, of the half-edges g and t: one entry is to stand for it.
  void join(std::uint32_t g, std::uint32_t t) {
    if (mesh_.origin(g) == mesh_.apex() || mesh_.origin(t) == mesh_.apex()) return;
    mesh_.clear_parked(g);
    if (mesh_.queued(g)) {
      if (!mesh_.queued(t)) return;
      mesh_.clear_queued(t);
      queue_.erase(t);
    } else if (!mesh_.queued(t)) {
      mesh_.set_queued(g);
      queue_.insert_now(g);
    }
  }

  // The edges at v cost something else now.
  void refresh(std::uint32_t v) {
    const std::uint32_t start = vertices_[v].leading;
    std::uint32_t h = start;
    bool more = true;
    while (more) {
      std::array<std::uint32_t, EdgeBatch::kSize> ids;
      std::size_t count = 0;
      while (more && count < ids.size()) {
        const std::uint32_t r = mesh_.target(h), t = mesh_.twin(h);
        if (r != mesh_.apex() && (mesh_.queued(h) || mesh_.queued(t))) {
          const std::uint32_t id = mesh_.queued(h) ? h : t;
          ids[count++] = id;
        }
        h = mesh_.around_vertex(h);
        more = h != start;
      }
      evaluate(std::span(ids).first(count));
      for (std::size_t i = 0; i < count; ++i) queue_.insert(ids[i], batch_.cost[i]);
    }
  }

  // Parked edges near v may have become legal.
  void revive(std::uint32_t v) {
    for (const Ring* ring : {&ring_p_, &ring_q_})
      for (const std::uint32_t r : ring->all())
        if (vertices_[r].has(CollapseVertex::kHasParked)) revive_at(r);
    if (vertices_[v].has(CollapseVertex::kHasParked)) revive_at(v);
  }
  void revive_at(std::uint32_t v) {
    vertices_[v].source &= ~CollapseVertex::kHasParked;
    const std::uint32_t start = vertices_[v].leading;
    std::uint32_t h = start;
    do {
      if (mesh_.parked(h)) {
        mesh_.clear_parked(h);
        mesh_.set_queued(h);
        queue_.insert_now(h);
      }
      h = mesh_.around_vertex(h);
    } while (h != start);
  }

  [[nodiscard]] bool held_by_error() {
    if (outcome_.rejected[static_cast<std::size_t>(Legality::kError)] == 0) return false;
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f)
      for (std::uint32_t h = 4 * f; h < 4 * f + 3; ++h) {
        if (!mesh_.alive(h) || !mesh_.parked(h)) continue;
        const CollapseVertex &p = vertices_[mesh_.origin(h)], &q = vertices_[mesh_.target(h)];
        evaluate(std::span(&h, 1));
        if (static_cast<double>(batch_.cost[0]) >
            limits_.error2 * (static_cast<double>(p.weight) + static_cast<double>(q.weight)))
          return true;
      }
    return false;
  }

  CollapseMesh& mesh_;
  detail::LargeArray<CollapseVertex>& vertices_;
  const Limits& limits_;
  bool keep_events_;
  Queue queue_;
  EdgeBatch batch_;
  std::size_t faces_, left_;
  std::array<Due, Queue::kBatch> due_;
  std::vector<std::uint32_t> touched_, sorted_;
  Ring ring_p_, ring_q_;
  detail::FaceTurns turns_;
  Outcome outcome_;
};

/// Adds w (n·x)² to the quadric of a vertex that the plane goes through.
void add_plane(CollapseVertex& v, const std::array<float, 3>& n, float w) {
  v.a[0] += w * n[0] * n[0];
  v.a[1] += w * n[0] * n[1];
  v.a[2] += w * n[0] * n[2];
  v.a[3] += w * n[1] * n[1];
  v.a[4] += w * n[1] * n[2];
  v.a[5] += w * n[2] * n[2];
  v.weight += w;
}

void sum_quadrics(CollapseMesh& mesh, float boundary_weight) {
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const CollapseMesh::Face& face = mesh.face(4 * f);
    std::array<CollapseVertex*, 3> v{};
    for (std::size_t i = 0; i < 3; ++i) v[i] = &mesh.vertices[face.origin[i]];
    const auto side = [&](std::size_t i) {
      const auto &a = v[i]->position, &b = v[(i + 1) % 3]->position;
      return std::array<float, 3>{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    };
    const std::array<float, 3> s = side(0), r = side(1);
    std::array<float, 3> n = {s[1] * r[2] - s[2] * r[1], s[2] * r[0] - s[0] * r[2],
                              s[0] * r[1] - s[1] * r[0]};
    const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0)) continue;
    for (float& x : n) x /= length;
    for (CollapseVertex* corner : v) add_plane(*corner, n, 0.5f * length);
    if (!(boundary_weight > 0)) continue;
    for (std::uint32_t i = 0; i < 3; ++i) {
      if (!mesh.is_ghost(face.twin[i])) continue;
      const std::array<float, 3> e = side(i);
      const float area = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
      if (!(area > 0)) continue;
      const float root = std::sqrt(area);
      const std::array<float, 3> across = {(e[1] * n[2] - e[2] * n[1]) / root,
                                           (e[2] * n[0] - e[0] * n[2]) / root,
                                           (e[0] * n[1] - e[1] * n[0]) / root};
      add_plane(*v[i], across, boundary_weight * area);
      add_plane(*v[(i + 1) % 3], across, boundary_weight * area);
    }
  }
}

Result<Outcome> run(CollapseMesh& mesh, const DecimateOptions& options, const Limits& limits,
                    std::size_t vertices, const Progress& progress) {
  const bool ends = options.operation == DecimateOperation::kHalfEdgeCollapse ||
                    options.placement == CollapsePlacement::kEndpoint;
  const auto decimated = [&](auto& decimation) { return decimation.run(progress); };
  if (ends) {
    Decimation<EndCollapse, LazyQueue> d(mesh, limits, mesh.face_count(), vertices, options.keep_history);
    return decimated(d);
  }
  if (options.placement == CollapsePlacement::kMidpoint) {
    Decimation<MidpointCollapse, ExactQueue> d(mesh, limits, mesh.face_count(), vertices,
                                               options.keep_history);
    return decimated(d);
  }
  Decimation<OptimalCollapse, LazyQueue> d(mesh, limits, mesh.face_count(), vertices, options.keep_history);
  return decimated(d);
}

template <class Point>
Point point_of(const std::array<float, 3>& local, const Frame& frame) {
  Point point;
  for (int k = 0; k < 3; ++k)
    point[k] = static_cast<typename Point::value_type>(
        frame.centre[k] + static_cast<double>(local[static_cast<std::size_t>(k)]) / frame.scale);
  return point;
}

template <class Point>
BasicDecimated<Point> gather(const CollapseMesh& mesh, std::span<const Point> points, bool in_order,
                             const Frame& frame, const Outcome& outcome) {
  BasicDecimated<Point> result;
  result.stop = outcome.stop;
  result.collapses = outcome.collapses;
  result.error = std::sqrt(outcome.error2) / frame.scale;
  result.relative_error = frame.diagonal > 0 ? result.error / frame.diagonal : 0;
  const auto rejected = [&](Legality why) { return outcome.rejected[static_cast<std::size_t>(why)]; };
  result.rejected_link = rejected(Legality::kLink);
  result.rejected_fold_over = rejected(Legality::kFoldOver);
  result.rejected_error = rejected(Legality::kError);
  result.rejected_locked = rejected(Legality::kLocked);
  result.history.reserve(outcome.events.size());
  for (const Event& e : outcome.events)
    result.history.push_back(
        {e.kept, e.removed, e.moved ? point_of<Point>(e.position, frame) : points[e.kept], e.faces});

  // Vertices and faces in the order of the input. The records are read once; what follows is in small arrays.
  const auto& vertices = mesh.vertices;
  const std::size_t n = points.size();
  constexpr std::uint32_t kMask = CollapseVertex::kSourceMask;
  std::vector<std::uint32_t>& new_vertex = result.vertex_map;
  new_vertex.assign(n, kInvalid);
  std::vector<std::uint32_t> absorbed(n, kInvalid), alive;  // `absorbed`: by which vertex, both of the input
  for (std::uint32_t v = 0; v < n; ++v) {
    const CollapseVertex& vertex = vertices[v];
    if (vertex.alive()) {
      alive.push_back(v);
      new_vertex[vertex.source & kMask] = 0;
    } else if (vertex.leading != kInvalid) {
      const std::uint32_t by = vertex.leading & ~CollapseVertex::kGone;
      absorbed[vertex.source & kMask] = in_order ? by : vertices[by].source & kMask;
    }
  }
  for (std::uint32_t v = 0; v < n; ++v) {
    if (new_vertex[v] == kInvalid) continue;
    new_vertex[v] = static_cast<std::uint32_t>(result.source_vertex.size());
    result.source_vertex.push_back(v);
  }
  result.positions.resize(alive.size());
  for (const std::uint32_t v : alive) {
    const CollapseVertex& vertex = vertices[v];
    const std::uint32_t source = vertex.source & kMask;
    result.positions[new_vertex[source]] =
        vertex.has(CollapseVertex::kMoved) ? point_of<Point>(vertex.position, frame) : points[source];
  }
  // Each vertex that went is found with the one that stands for it in the end.
  std::vector<std::uint32_t> path;
  for (std::uint32_t v = 0; v < n; ++v) {
    std::uint32_t at = v;
    path.clear();
    while (absorbed[at] != kInvalid) {
      path.push_back(at);
      at = absorbed[at];
    }
    for (const std::uint32_t gone : path) {
      absorbed[gone] = kInvalid;
      new_vertex[gone] = new_vertex[at];
    }
  }

  std::vector<std::uint32_t> new_face(mesh.face_count(), kInvalid), alive_faces;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const CollapseMesh::Face& face = mesh.face(4 * f);
    if (!face.alive()) continue;
    alive_faces.push_back(f);
    new_face[face.source] = 0;
  }
  for (std::uint32_t f = 0; f < new_face.size(); ++f) {
    if (new_face[f] == kInvalid) continue;
    new_face[f] = static_cast<std::uint32_t>(result.source_face.size());
    result.source_face.push_back(f);
  }
  std::vector<std::uint32_t> origin(3 * result.source_face.size()), twin(origin.size()),
      leading(result.positions.size(), kInvalid);
  for (const std::uint32_t f : alive_faces) {
    const CollapseMesh::Face& face = mesh.face(4 * f);
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t h = 3 * new_face[face.source] + i, t = face.twin[i];
      origin[h] = new_vertex[vertices[face.origin[i]].source & kMask];
      twin[h] = mesh.is_ghost(t) ? kInvalid : 3 * new_face[mesh.face(t).source] + t % 4;
    }
  }
  for (std::uint32_t h = 0; h < origin.size(); ++h)
    if (leading[origin[h]] == kInvalid || twin[h] == kInvalid) leading[origin[h]] = h;
  result.mesh = HalfEdgeMesh::from_arrays(std::move(origin), std::move(twin), std::move(leading));
  return result;
}

Result<void> check(const DecimateOptions& options, std::size_t vertices) {
  const auto usage = [](const char* what) { return fail(ErrorCode::kUsage, what); };
  if (options.max_error && !(*options.max_error >= 0)) return usage("max_error must be at least 0");
  if (options.max_relative_error && !(*options.max_relative_error >= 0))
    return usage("max_relative_error must be at least 0");
  if (options.target_ratio && !(*options.target_ratio >= 0 && *options.target_ratio <= 1))
    return usage("target_ratio must lie between 0 and 1");
  if (options.time_limit && !(*options.time_limit >= 0)) return usage("time_limit must be at least 0");
  if (!(options.max_normal_deviation > 0 && options.max_normal_deviation < std::numbers::pi))
    return usage("max_normal_deviation must lie between 0 and pi");
  if (!(options.boundary_weight >= 0 && std::isfinite(options.boundary_weight)))
    return usage("boundary_weight must be at least 0 and finite");
  for (const std::uint32_t v : options.locked_vertices)
    if (v >= vertices) return usage("a locked vertex is not of the mesh");
  return {};
}

template <class Point>
Result<BasicDecimated<Point>> decimate_arrays(std::span<const Point> points,
                                              std::span<const std::uint32_t> corners,
                                              const DecimateOptions& options, const Progress& progress) {
  const auto begun = std::chrono::steady_clock::now();
  VKMESH_CHECK(check(options, points.size()));
  if (corners.size() % 3 != 0) return fail(ErrorCode::kUsage, "decimation takes three corners a face");
  if (corners.size() / 3 > CollapseMesh::kMaxFaces || points.size() > CollapseMesh::kMaxVertices)
    return fail(ErrorCode::kUnsuitable,
                "decimation takes at most 2^28 vertices, 2^29 faces and boundary edges");
  for (const std::uint32_t c : corners)
    if (c >= points.size()) return fail(ErrorCode::kUsage, "a corner names no point");
  for (const Point& p : points)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      return fail(ErrorCode::kUnsuitable, "decimation needs finite positions");
  VKMESH_TRY(const Frame frame, frame_of(points, corners));
  const auto local = [&](std::size_t v) {
    std::array<float, 3> x;
    for (int k = 0; k < 3; ++k)
      x[static_cast<std::size_t>(k)] =
          static_cast<float>((static_cast<double>(points[v][k]) - frame.centre[k]) * frame.scale);
    return x;
  };

  CollapseMesh mesh;
  std::vector<std::uint32_t> order, leading;
  bool manifold = false;
  if (detail::lacks_locality(points.size(), corners)) {
    order = detail::morton_order(points.size(), local);
    std::vector<std::uint32_t> rank(points.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
    const std::size_t faces = corners.size() / 3;
    std::vector<std::uint32_t> face_order(faces), sorted(corners.size());
    detail::counting_sort(
        points.size(), faces,
        [&](std::size_t f) {
          return std::min({rank[corners[3 * f]], rank[corners[3 * f + 1]], rank[corners[3 * f + 2]]});
        },
        [&](std::size_t slot, std::size_t f) {
          face_order[slot] = static_cast<std::uint32_t>(f);
          for (std::size_t i = 0; i < 3; ++i) sorted[3 * slot + i] = rank[corners[3 * f + i]];
        });
    manifold = mesh.build(points.size(), sorted, leading);
    if (manifold)
      for (std::uint32_t f = 0; f < faces; ++f) mesh.face(4 * f).source = face_order[f];
  } else {
    manifold = mesh.build(points.size(), corners, leading);
  }
  if (!manifold)
    return fail(ErrorCode::kUnsuitable, "decimation takes oriented manifolds only: consolidate first");

  std::size_t used = 0;
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    CollapseVertex& vertex = mesh.vertices[v];
    const std::uint32_t source = order.empty() ? v : order[v];
    vertex = {};
    vertex.position = local(source);
    vertex.leading = leading[v];
    vertex.source = source;
    used += leading[v] != kInvalid ? 1 : 0;
  }
  leading = {};
  mesh.vertices[mesh.apex()] = {};
  if (!options.locked_vertices.empty()) {
    std::vector<bool> locked(points.size(), false);
    for (const std::uint32_t v : options.locked_vertices) locked[v] = true;
    for (std::size_t v = 0; v < points.size(); ++v)
      if (locked[mesh.vertices[v].source]) mesh.vertices[v].source |= CollapseVertex::kLocked;
  }
  if (options.boundary == DecimateBoundary::kKept)
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      for (std::uint32_t i = 0; i < 3; ++i)
        if (mesh.is_ghost(mesh.twin(4 * f + i)))
          mesh.vertices[mesh.origin(4 * f + i)].source |= CollapseVertex::kLocked;
  const bool in_order = order.empty();
  order = {};
  sum_quadrics(mesh, options.boundary == DecimateBoundary::kInShape
                         ? static_cast<float>(options.boundary_weight)
                         : 0.0f);

  Limits limits;
  limits.faces = options.target_faces.value_or(0);
  if (options.target_ratio)
    limits.faces = std::max(
        limits.faces, static_cast<std::size_t>(
                          std::llround(*options.target_ratio * static_cast<double>(mesh.face_count()))));
  limits.vertices = options.target_vertices.value_or(0);
  double bound = std::numeric_limits<double>::infinity();
  if (options.max_error) bound = *options.max_error * frame.scale;
  if (options.max_relative_error)
    bound = std::min(bound, *options.max_relative_error * frame.diagonal * frame.scale);
  limits.error2 = bound * bound;
  limits.cos_deviation = static_cast<float>(std::cos(options.max_normal_deviation));
  if (options.time_limit)
    limits.seconds =
        *options.time_limit - std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  VKMESH_TRY(Outcome outcome, run(mesh, options, limits, used, progress));
  return gather(mesh, points, in_order, frame, outcome);
}

template <class Point>
Result<BasicDecimated<Point>> decimate_mesh(const HalfEdgeMesh& mesh, std::span<const Point> positions,
                                            const DecimateOptions& options, const Progress& progress) {
  if (!mesh.is_triangles())
    return fail(ErrorCode::kUnsuitable, "decimation takes triangles only: triangulate first");
  if (positions.size() != mesh.vertex_count())
    return fail(ErrorCode::kUsage, "decimation needs one position for each vertex");
  return detail::catching([&]() -> Result<BasicDecimated<Point>> {
    return decimate_arrays(positions, mesh.origins(), options, progress);
  });
}

}  // namespace

std::string name_of(DecimateStop stop) {
  switch (stop) {
    case DecimateStop::kTargetReached:
      return "target reached";
    case DecimateStop::kErrorBound:
      return "error bound";
    case DecimateStop::kTimeLimit:
      return "time limit";
    case DecimateStop::kNoLegalCollapse:
      break;
  }
  return "no legal collapse";
}

Result<Decimated> decimate(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                           const DecimateOptions& options, const Progress& progress) {
  return decimate_mesh(mesh, positions, options, progress);
}

Result<BasicDecimated<DVec3>> decimate(const HalfEdgeMesh& mesh, std::span<const DVec3> positions,
                                       const DecimateOptions& options, const Progress& progress) {
  return decimate_mesh(mesh, positions, options, progress);
}

Result<Decimated> decimate(const TriangleSurface& surface, const DecimateOptions& options,
                           const Progress& progress) {
  return detail::catching([&]() -> Result<Decimated> {
    return decimate_arrays(surface.points, surface.corners, options, progress);
  });
}

}  // namespace vkmesh
