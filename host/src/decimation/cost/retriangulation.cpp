#include "decimation/cost/retriangulation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "simd/lanes.h"
#include "simd/target_clones.h"

namespace vkmesh::detail {
namespace {

constexpr std::size_t kLanes = RetriangulationBatch::kLanes,
                      kMaxNeighbours = RetriangulationBatch::kMaxNeighbours,
                      kPairs = RetriangulationBatch::kPairs;
constexpr std::size_t kTriples = RetriangulationAttributes::kTriples;
using Lanes = RetriangulationBatch::Lanes;
using Flags = std::array<std::int32_t, kLanes>;

/// A triangle of less area than this share of its squared sides has no reliable normal; as in folds_over.
constexpr float kDegenerate = 1e-6f;
/// A new triangle of less than this share of its squared sides is a sliver: it takes the place only of faces
/// that were less than so many times as wide.
constexpr float kSliver = 1e-4f, kThinner = 10;
/// What a new edge counts, for each unit of v's area and of its squared length: it decides where the ground
/// is as good as flat.
constexpr float kOfLength = 1e-7f;
/// Least cosine between a new face and the normal along which all is seen: steeper ones have no reliable
/// height.
constexpr float kSteepest = 0.05f;
/// Heights that are less than this share of the distance to the farthest neighbour may be rounding, and are
/// 0.
constexpr float kRounding = 1.0f / (1 << 21);
constexpr float kNone = RetriangulationBatch::kNone;

constexpr std::size_t pair(std::size_t a, std::size_t b) {
  return RetriangulationBatch::pair(a, b);
}
/// The index of a triple a < b < c: c is the slowest to rise, then b.
constexpr std::size_t triple(std::size_t a, std::size_t b, std::size_t c) {
  return c * (c - 1) * (c - 2) / 6 + pair(a, b);
}

using Vectors = std::array<Lanes, 3>;

/// What is known of a batch on the way to its result. Lengths are scaled.
struct alignas(64) Work {
  std::array<Vectors, kMaxNeighbours> ring;
  std::array<Vectors, kPairs> cross;  // of two neighbours
  std::array<Lanes, kPairs> distance2;
  Vectors up;
  std::array<Vectors, kMaxNeighbours> face;   // of v, by the first neighbour: twice its area vector
  std::array<Lanes, kMaxNeighbours> quarter;  // of twice its area
  std::array<Lanes, kMaxNeighbours> limit,
      spoke;  // least product with a unit normal, squared; weight of a crossing
  std::array<Lanes, kMaxNeighbours> reliable;  // 0: the face has no reliable normal; else kNone
  std::array<Lanes, kMaxNeighbours> slimmest;  // what a sliver in its place has of its squared sides, squared
  std::array<Lanes, kPairs> ahead, behind;     // max(0, left), max(0, -left)
  std::array<Lanes, kPairs> inside, outside;   // what a new edge crosses where v lies left of it, and right
  std::array<Lanes, kTriples> at_v, total;
  std::array<Lanes, kPairs> best, error;
  Lanes scale, back2, back4, rounding2, area, along0, along1, along2, base, of_length;
  Lanes toward;   // where on its new edge a vertex on a boundary or seam goes, from 0 to 1
  Lanes illegal;  // kNone where it is so, else 0
  std::size_t n;
};

// Scaled by a power of two, so that no product leaves the range of a float.
void scale_ring(const RetriangulationBatch& batch, Work& w) {
  alignas(64) Lanes largest{};
  for (std::size_t i = 0; i < w.n; ++i) VKMESH_FOR_LANES(l, kLanes) {
      const float x = batch.ring[i][0][l] - batch.v[0][l], y = batch.ring[i][1][l] - batch.v[1][l],
                  z = batch.ring[i][2][l] - batch.v[2][l];
      w.ring[i][0][l] = x;
      w.ring[i][1][l] = y;
      w.ring[i][2][l] = z;
      const float squared = x * x + y * y + z * z, before = largest[l];
      largest[l] = squared > before ? squared : before;
    }
  VKMESH_FOR_LANES(l, kLanes) {
    const std::int32_t half =
        (static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(largest[l]) >> 23) - 127) >> 1;
    const float scale = std::bit_cast<float>(static_cast<std::uint32_t>(127 - half) << 23);
    const float back = std::bit_cast<float>(static_cast<std::uint32_t>(127 + half) << 23);
    w.scale[l] = scale;
    w.back2[l] = back * back;
    w.back4[l] = (back * back) * (back * back);
    w.rounding2[l] = kRounding * kRounding * largest[l] * (scale * scale);
  }
  for (std::size_t i = 0; i < w.n; ++i)
    for (std::size_t k = 0; k < 3; ++k) VKMESH_FOR_LANES(l, kLanes) w.ring[i][k][l] *= w.scale[l];
}

void cross_all(Work& w) {
  for (std::size_t j = 1; j < w.n; ++j)
    for (std::size_t i = 0; i < j; ++i) {
      const std::size_t ij = pair(i, j);
      VKMESH_FOR_LANES(l, kLanes) {
        const float ax = w.ring[i][0][l], ay = w.ring[i][1][l], az = w.ring[i][2][l];
        const float bx = w.ring[j][0][l], by = w.ring[j][1][l], bz = w.ring[j][2][l];
        const float dx = bx - ax, dy = by - ay, dz = bz - az;
        w.cross[ij][0][l] = ay * bz - az * by;
        w.cross[ij][1][l] = az * bx - ax * bz;
        w.cross[ij][2][l] = ax * by - ay * bx;
        w.distance2[ij][l] = dx * dx + dy * dy + dz * dz;
        w.inside[ij][l] = 0;
        w.outside[ij][l] = 0;
      }
    }
}

// The faces of v. What is the last where v lies on the boundary, is none, of no area.
void find_faces(const RetriangulationBatch& batch, Work& w, float square_cos) {
  const std::size_t n = w.n;
  for (std::size_t k = 0; k < 3; ++k) {
    w.up[k].fill(0);
    for (std::size_t i = 0; i + 1 < n; ++i) VKMESH_FOR_LANES(l, kLanes) {
        const float x = w.cross[pair(i, i + 1)][k][l];
        w.face[i][k][l] = x;
        w.up[k][l] += x;
      }
    VKMESH_FOR_LANES(l, kLanes) {
      const float x = batch.closed[l] * -w.cross[pair(0, n - 1)][k][l];
      w.face[n - 1][k][l] = x;
      w.up[k][l] += x;
    }
  }
  VKMESH_FOR_LANES(l, kLanes) {
    const float x = w.up[0][l], y = w.up[1][l], z = w.up[2][l];
    const float size = std::sqrt(x * x + y * y + z * z);
    const float over = 1.0f / (size > 0 ? size : 1.0f);
    w.illegal[l] = size > 0 ? 0.0f : kNone;
    w.up[0][l] = x * over;
    w.up[1][l] = y * over;
    w.up[2][l] = z * over;
    w.area[l] = 0;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = i + 1 < n ? i + 1 : 0;
    VKMESH_FOR_LANES(l, kLanes) {
      const float x = w.face[i][0][l], y = w.face[i][1][l], z = w.face[i][2][l];
      const float ax = w.ring[i][0][l], ay = w.ring[i][1][l], az = w.ring[i][2][l];
      const float bx = w.ring[j][0][l], by = w.ring[j][1][l], bz = w.ring[j][2][l];
      const float sides = (ax * ax + ay * ay + az * az) + (bx * bx + by * by + bz * bz);
      const float twice = std::sqrt(x * x + y * y + z * z);
      const float looks = w.up[0][l] * x + w.up[1][l] * y + w.up[2][l] * z;
      const bool reliable = twice > kDegenerate * sides;
      w.illegal[l] = std::max(w.illegal[l], looks >= -kDegenerate * sides ? 0.0f : kNone);
      w.limit[i][l] = reliable ? square_cos * (twice * twice) : -1e30f;
      w.reliable[i][l] = reliable ? kNone : 0.0f;
      const float slimmest = twice / (kThinner * (sides > 0 ? sides : 1.0f));
      w.slimmest[i][l] = slimmest * slimmest;
      w.area[l] += 0.5f * twice;
      w.quarter[i][l] = 0.25f * twice;
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = i > 0 ? i - 1 : n - 1;
    VKMESH_FOR_LANES(l, kLanes) w.spoke[i][l] = (w.quarter[before][l] + w.quarter[i][l]) * w.back4[l];
  }
  VKMESH_FOR_LANES(l, kLanes) {
    const float is_none = batch.closed[l] > 0 ? 0.0f : kNone;
    w.reliable[n - 1][l] = std::max(w.reliable[n - 1][l], is_none);
    w.slimmest[n - 1][l] += is_none;
  }
}

// On which side of each edge v lies; around it the ring goes once at most.
void find_sides(RetriangulationBatch& batch, Work& w) {
  const std::size_t n = w.n;
  for (std::size_t j = 1; j < n; ++j)
    for (std::size_t i = 0; i < j; ++i) {
      const std::size_t ij = pair(i, j);
      const float least = j == i + 1 ? 0.0f : -kNone;
      VKMESH_FOR_LANES(l, kLanes) {
        const float x =
            w.up[0][l] * w.cross[ij][0][l] + w.up[1][l] * w.cross[ij][1][l] + w.up[2][l] * w.cross[ij][2][l];
        batch.left[ij][l] = std::max(least, x);
      }
    }
  const std::size_t root = pair(0, n - 1);
  VKMESH_FOR_LANES(l, kLanes)
  batch.left[root][l] = std::min(batch.left[root][l], batch.closed[l] > 0 ? 0.0f : kNone);
  for (std::size_t ij = 0; ij < pair(0, n); ++ij) VKMESH_FOR_LANES(l, kLanes) {
      const float x = batch.left[ij][l];
      w.ahead[ij][l] = std::max(0.0f, x);
      w.behind[ij][l] = std::max(0.0f, -x);
    }
  alignas(64) Lanes beyond{}, again{};
  for (std::size_t i = 1; i < n; ++i) {
    const std::size_t from_first = pair(0, i);
    VKMESH_FOR_LANES(l, kLanes) {
      const float was = beyond[l], found = again[l];
      const float x = w.ahead[from_first][l], y = w.behind[from_first][l];
      const float both = x < was ? x : was;
      again[l] = both > found ? both : found;
      beyond[l] = y > was ? y : was;
    }
  }
  VKMESH_FOR_LANES(l, kLanes) w.illegal[l] = std::max(w.illegal[l], again[l] > 0 ? kNone : 0.0f);
}

/// Where the new edge that a vertex on a boundary or seam goes to ends, which begins at the first neighbour;
/// 1 where it lies on neither.
struct Curve {
  const Vectors& to;
  const Lanes& is_none;
};

// The quadric along the normal, and on the new edge of a boundary or seam.
void find_quadric(const RetriangulationBatch& batch, const Curve& curve, Work& w) {
  VKMESH_FOR_LANES(l, kLanes) {
    const float x = w.up[0][l], y = w.up[1][l], z = w.up[2][l];
    const float a0 = batch.a[0][l], a1 = batch.a[1][l], a2 = batch.a[2][l], a3 = batch.a[3][l],
                a4 = batch.a[4][l], a5 = batch.a[5][l];
    const float b0 = batch.b[0][l], b1 = batch.b[1][l], b2 = batch.b[2][l];
    const float back = 1.0f / w.scale[l];
    const float closed = curve.is_none[l];
    w.along0[l] = closed * batch.c[l];
    w.along1[l] = closed * (x * b0 + y * b1 + z * b2) * back;
    w.along2[l] =
        (x * (a0 * x + 2 * (a1 * y + a2 * z)) + y * (a3 * y + 2 * a4 * z) + a5 * z * z) * w.back2[l];
    w.of_length[l] = kOfLength * w.area[l] * w.back4[l];
    const float px = batch.ring[0][0][l] - batch.v[0][l], py = batch.ring[0][1][l] - batch.v[1][l],
                pz = batch.ring[0][2][l] - batch.v[2][l];
    const float dx = curve.to[0][l] - batch.ring[0][0][l], dy = curve.to[1][l] - batch.ring[0][1][l],
                dz = curve.to[2][l] - batch.ring[0][2][l];
    const float squared = dx * dx + dy * dy + dz * dz;
    const float along = -(px * dx + py * dy + pz * dz) / (squared > 0 ? squared : 1.0f);
    const float t = along > 1 ? 1.0f : along > 0 ? along : 0.0f;
    w.toward[l] = t;
    const float qx = px + t * dx, qy = py + t * dy, qz = pz + t * dz;
    const float q = batch.c[l] + qx * ((a0 * qx + a1 * qy + a2 * qz) + 2 * b0) +
                    qy * ((a1 * qx + a3 * qy + a4 * qz) + 2 * b1) +
                    qz * ((a2 * qx + a4 * qy + a5 * qz) + 2 * b2);
    w.base[l] = closed > 0 || !(q > 0) ? 0.0f : q;
  }
}

// Which edges of a triangle a, b, c are sides of the hole.
constexpr unsigned kAB = 1, kBC = 2, kCA = 4;

/// What the triangle costs, and the new edges by what lies across them. All in registers: a mask that is
/// stored and loaded again in another shape would wait for memory.
template <unsigned kSides>
[[gnu::always_inline]] inline void judge_triangle(const RetriangulationBatch& batch, Work& w, std::size_t a,
                                                  std::size_t b, std::size_t c, std::size_t abc) {
  const std::size_t ab = pair(a, b), bc = pair(b, c), ac = pair(a, c), last = w.n - 1;
  VKMESH_FOR_LANES(l, kLanes) {
    const float px = w.cross[bc][0][l], py = w.cross[bc][1][l], pz = w.cross[bc][2][l];
    const float nx = w.cross[ab][0][l] + px - w.cross[ac][0][l];
    const float ny = w.cross[ab][1][l] + py - w.cross[ac][1][l];
    const float nz = w.cross[ab][2][l] + pz - w.cross[ac][2][l];
    const float det = w.ring[a][0][l] * px + w.ring[a][1][l] * py + w.ring[a][2][l] * pz;
    const float x1 = batch.left[ab][l], x2 = batch.left[bc][l], x3 = -batch.left[ac][l];
    const float whole = w.ahead[ab][l] + w.ahead[bc][l] + w.behind[ac][l];
    const float height = whole > 0 ? det / whole : 0.0f;
    const float height2 = height * height;
    const float apart = height2 > w.rounding2[l] ? height : 0.0f;
    const float apart2 = height2 > w.rounding2[l] ? height2 : 0.0f;
    const float value = w.along0[l] + apart * (2 * w.along1[l] + apart * w.along2[l]);
    const bool holds = (x1 >= 0) & (x2 >= 0) & ((kSides & kCA) != 0 ? x3 >= 0 : x3 > 0) & (value > 0);
    const float at_v = holds ? value : 0.0f;
    const float size2 = nx * nx + ny * ny + nz * nz, looks = x1 + x2 + x3;
    const float sides = w.distance2[ab][l] + w.distance2[bc][l], least = kDegenerate * sides;
    const bool has_area = size2 > least * least;
    const float length2 = has_area ? size2 : 0.0f;
    float without = has_area ? 0.0f : kNone;
    float thin = size2 > kSliver * kSliver * (sides * sides) ? 0.0f : kNone;
    bool misfit = has_area & (looks * std::fabs(looks) < kSteepest * kSteepest * size2);
    const auto turn = [&](std::size_t f) __attribute__((always_inline)) {
      const float along = nx * w.face[f][0][l] + ny * w.face[f][1][l] + nz * w.face[f][2][l];
      misfit |= has_area & (along * std::fabs(along) < w.limit[f][l] * length2);
      without = std::min(without, w.reliable[f][l]);
      thin = size2 >= w.slimmest[f][l] * (sides * sides) ? 0.0f : thin;
    };
    if constexpr ((kSides & kAB) != 0) turn(a);
    if constexpr ((kSides & kBC) != 0) turn(b);
    if constexpr ((kSides & kCA) != 0) turn(last);
    w.at_v[abc][l] = at_v;
    w.total[abc][l] = misfit ? kNone : at_v + (without + thin);
    w.inside[ac][l] += w.spoke[b][l] * apart2;
    w.outside[ab][l] += w.spoke[c][l] * apart2;
    w.outside[bc][l] += w.spoke[a][l] * apart2;
  }
}

template <unsigned kSides = 0>
void judge(const RetriangulationBatch& batch, Work& w, unsigned sides, std::size_t a, std::size_t b,
           std::size_t c, std::size_t abc) {
  if (kSides == (kAB | kBC | kCA) || sides == kSides)
    judge_triangle<kSides>(batch, w, a, b, c, abc);
  else if constexpr (kSides < (kAB | kBC | kCA))
    judge<kSides + 1>(batch, w, sides, a, b, c, abc);
}

void judge_all(const RetriangulationBatch& batch, Work& w) {
  std::size_t abc = 0;
  for (std::size_t c = 2; c < w.n; ++c)
    for (std::size_t b = 1; b < c; ++b)
      for (std::size_t a = 0; a < b; ++a, ++abc) {
        const unsigned sides =
            (a + 1 == b ? kAB : 0) | (b + 1 == c ? kBC : 0) | (a == 0 && c + 1 == w.n ? kCA : 0);
        judge(batch, w, sides, a, b, c, abc);
      }
}

// What the shapes of triangles count.
void add_shapes(const RetriangulationBatch& batch, Work& w) {
  constexpr float kEquilateral = 1.1547005f;  // twice the area over the squared side, inverted
  alignas(64) Lanes most{};
  for (std::size_t i = 0; i < w.n; ++i) VKMESH_FOR_LANES(l, kLanes) {
      const float x = w.ring[i][0][l], y = w.ring[i][1][l], z = w.ring[i][2][l];
      most[l] += (x * x + y * y + z * z) / static_cast<float>(w.n);
    }
  VKMESH_FOR_LANES(l, kLanes) most[l] *= batch.shape * batch.weight[l] * w.back2[l];
  std::size_t abc = 0;
  for (std::size_t c = 2; c < w.n; ++c)
    for (std::size_t b = 1; b < c; ++b)
      for (std::size_t a = 0; a < b; ++a, ++abc) {
        const std::size_t ab = pair(a, b), bc = pair(b, c), ac = pair(a, c);
        VKMESH_FOR_LANES(l, kLanes) {
          const float nx = w.cross[ab][0][l] + w.cross[bc][0][l] - w.cross[ac][0][l];
          const float ny = w.cross[ab][1][l] + w.cross[bc][1][l] - w.cross[ac][1][l];
          const float nz = w.cross[ab][2][l] + w.cross[bc][2][l] - w.cross[ac][2][l];
          const float p = w.distance2[ab][l], q = w.distance2[bc][l], r = w.distance2[ac][l];
          const float longest2 = std::max(std::max(p, q), r);
          const float quality =
              kEquilateral * std::sqrt(nx * nx + ny * ny + nz * nz) / (longest2 > 0 ? longest2 : 1.0f);
          w.total[abc][l] += most[l] * (1 - quality);
        }
      }
}

// Where the new edges of boundaries and seams end, which begin at the first neighbour.
void find_curves(const RetriangulationBatch& batch, const RetriangulationAttributes& attributes, Vectors& to,
                 Lanes& is_none) {
  for (std::size_t l = 0; l < kLanes; ++l) {
    is_none[l] = attributes.split[l] != 0 ? 0.0f : batch.closed[l];
    for (std::size_t k = 0; k < 3; ++k)
      to[k][l] = batch.ring[static_cast<std::size_t>(attributes.last[l])][k][l];
  }
}

// What it costs where a neighbour takes over all that v stands for; on the new edge of a boundary or seam,
// where both ends take their shares.
void find_heirs(const RetriangulationBatch& batch, const Curve& curve, const Work& w,
                RetriangulationAttributes& attributes) {
  const auto& a = attributes.a;
  const auto& b = attributes.b;
  for (std::size_t i = 0; i < w.n; ++i) {
    alignas(64) Vectors at;
    auto& [one, other] = attributes.receiver[i];
    VKMESH_FOR_LANES(l, kLanes) {
      const float x = batch.ring[i][0][l] - batch.v[0][l], y = batch.ring[i][1][l] - batch.v[1][l],
                  z = batch.ring[i][2][l] - batch.v[2][l];
      const float left = attributes.c[l] + x * (a[0][l] * x + 2 * (a[1][l] * y + a[2][l] * z + b[0][l])) +
                         y * (a[3][l] * y + 2 * (a[4][l] * z + b[1][l])) + z * (a[5][l] * z + 2 * b[2][l]);
      at[0][l] = x;
      at[1][l] = y;
      at[2][l] = z;
      one[l] = left > 0 ? left : 0.0f;
      other[l] = 0;
    }
    for (const auto& component : attributes.components)
      for (std::size_t side = 0; side < 2; ++side) {
        const auto& [off, gradient, ring] = component.side[side];
        Lanes& sum = attributes.receiver[i][side];
        VKMESH_FOR_LANES(l, kLanes) {
          const float apart = (off[l] - ring[i][l]) + (gradient[0][l] * at[0][l] + gradient[1][l] * at[1][l] +
                                                       gradient[2][l] * at[2][l]);
          sum[l] += component.cost * attributes.weight[side][l] * (apart * apart);
        }
      }
  }
  for (std::size_t l = 0; l < kLanes; ++l) {
    const auto all = [&](std::size_t i) {
      const auto& [one, other] = attributes.receiver[i];
      return one[l] + (attributes.split[l] != 0 ? other[l] : 0.0f);
    };
    const float t = w.toward[l];
    const auto last = static_cast<std::size_t>(attributes.last[l]);
    attributes.error[l] = curve.is_none[l] > 0 ? 0.0f : (1 - t) * all(0) + t * all(last);
  }
}

// What attributes make of each triangle, and of the new edges by what lies across them.
void judge_attributes(const RetriangulationBatch& batch, const Curve& curve, Work& w,
                      RetriangulationAttributes& attributes) {
  const std::size_t n = w.n;
  for (std::size_t ij = 0; ij < pair(0, n); ++ij) {
    attributes.inside[ij].fill(0);
    attributes.outside[ij].fill(0);
  }
  std::size_t abc = 0;
  for (std::size_t c = 2; c < n; ++c)
    for (std::size_t b = 1; b < c; ++b)
      for (std::size_t a = 0; a < b; ++a, ++abc) {
        const std::size_t ab = pair(a, b), bc = pair(b, c), ac = pair(a, c);
        const auto ia = static_cast<std::int32_t>(a), ib = static_cast<std::int32_t>(b),
                   ic = static_cast<std::int32_t>(c);
        alignas(64) Lanes whole, crossing{}, counts;
        alignas(64) Flags on_first;
        VKMESH_FOR_LANES(l, kLanes) {
          const float sum = w.ahead[ab][l] + w.ahead[bc][l] + w.behind[ac][l];
          whole[l] = sum > 0 ? sum : 1.0f;
          // No triangle across the seam is made, and what it says of edges is no matter of either side.
          const std::int32_t last = attributes.last[l];
          on_first[l] = ic <= last;
          counts[l] = ((ic <= last) | (((ia == 0) | (ia >= last)) & (ib >= last))) ? 1.0f : 0.0f;
        }
        for (const auto& component : attributes.components) {
          const RetriangulationAttributes::OnSide &one = component.side[0], &other = component.side[1];
          VKMESH_FOR_LANES(l, kLanes) {
            const bool is_one = on_first[l] != 0;
            const float at_a = is_one ? one.ring[a][l] : other.ring[a][l],
                        at_b = is_one ? one.ring[b][l] : other.ring[b][l],
                        at_c = is_one ? one.ring[c][l] : other.ring[c][l];
            const float apart =
                (batch.left[bc][l] * at_a - batch.left[ac][l] * at_b + batch.left[ab][l] * at_c) / whole[l];
            crossing[l] += component.cost * apart * apart;
          }
        }
        const bool last_is_side = a == 0 && c + 1 == n;
        const Lanes &heir_a = attributes.receiver[a][0], &heir_b = attributes.receiver[b][0],
                    &heir_c = attributes.receiver[c][0];
        VKMESH_FOR_LANES(l, kLanes) {
          const float x1 = batch.left[ab][l], x2 = batch.left[bc][l], x3 = -batch.left[ac][l];
          const bool holds = (x1 >= 0) & (x2 >= 0) & ((x3 > 0) | (last_is_side & (x3 >= 0)));
          const float taken = (x2 * heir_a[l] + x3 * heir_b[l] + x1 * heir_c[l]) / whole[l];
          const float at_v = (holds & (curve.is_none[l] > 0)) ? taken : 0.0f;
          attributes.at_v[abc][l] = at_v;
          w.total[abc][l] += at_v;
          const float each = counts[l] * crossing[l] * (w.scale[l] * w.scale[l]);
          attributes.inside[ac][l] += w.spoke[b][l] * each;
          attributes.outside[ab][l] += w.spoke[c][l] * each;
          attributes.outside[bc][l] += w.spoke[a][l] * each;
        }
      }
  for (std::size_t c = 1; c < n; ++c)
    for (std::size_t a = 0; a < c; ++a) {
      const std::size_t ac = pair(a, c);
      const bool is_root = a == 0 && c + 1 == n;
      VKMESH_FOR_LANES(l, kLanes) {
        const bool is_new = !(is_root & (batch.closed[l] > 0));
        const float x = batch.left[ac][l];
        const float crossed = x > 0 ? attributes.inside[ac][l] : x < 0 ? attributes.outside[ac][l] : 0.0f;
        attributes.edge[ac][l] = is_new ? crossed : 0.0f;
      }
    }
}

// Sums the errors of attributes over the triangulations that were chosen.
void sum_attributes(const RetriangulationBatch& batch, const Work& w, RetriangulationAttributes& attributes) {
  std::array<std::pair<std::size_t, std::size_t>, kMaxNeighbours> parts;
  for (std::size_t l = 0; l < kLanes; ++l) {
    if (!(batch.error[l] < kNone)) continue;
    float sum = 0;
    std::size_t left = 0;
    parts[left++] = {0, w.n - 1};
    while (left > 0) {
      const auto [a, c] = parts[--left];
      if (a + 1 == c) continue;
      const auto b = static_cast<std::size_t>(batch.third[pair(a, c)][l]);
      sum += attributes.edge[pair(a, c)][l] + attributes.at_v[triple(a, b, c)][l];
      parts[left++] = {a, b};
      parts[left++] = {b, c};
    }
    attributes.error[l] += sum;
  }
}

/// The best of kCount third corners from `from` on, and of those before when these are not the first.
template <std::size_t kCount, bool kAreFirst>
[[gnu::always_inline]] inline void choose(RetriangulationBatch& batch, Work& w, std::size_t a, std::size_t c,
                                          std::size_t from) {
  const std::size_t ac = pair(a, c);
  VKMESH_FOR_LANES(l, kLanes) {
    float least = kNone, error = 0;
    auto third = static_cast<std::int32_t>(a + 1);
    if constexpr (!kAreFirst) {
      least = w.best[ac][l];
      error = w.error[ac][l];
      third = batch.third[ac][l];
    }
    for (std::size_t i = 0; i < kCount; ++i) {
      const std::size_t b = from + i, ab = pair(a, b), bc = pair(b, c), abc = triple(a, b, c);
      const float sum = w.best[ab][l] + w.best[bc][l] + w.total[abc][l];
      const float part = w.error[ab][l] + w.error[bc][l] + w.at_v[abc][l];
      const bool less = sum < least;
      least = less ? sum : least;
      error = less ? part : error;
      third = less ? static_cast<std::int32_t>(b) : third;
    }
    w.best[ac][l] = least;
    w.error[ac][l] = error;
    batch.third[ac][l] = third;
  }
}

// The best of each part between two neighbours.
template <bool kAttributes>
void choose_all(RetriangulationBatch& batch, Work& w, const RetriangulationAttributes* attributes) {
  const std::size_t n = w.n, root = pair(0, n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    w.best[pair(i, i + 1)].fill(0);
    w.error[pair(i, i + 1)].fill(0);
  }
  for (std::size_t span = 2; span < n; ++span)
    for (std::size_t a = 0; a + span < n; ++a) {
      const std::size_t c = a + span, ac = pair(a, c);
      std::size_t b = a + 1;
      if (c - b == 1)
        choose<1, true>(batch, w, a, c, b);
      else if (c - b == 2)
        choose<2, true>(batch, w, a, c, b);
      else if (c - b == 3)
        choose<3, true>(batch, w, a, c, b);
      else
        choose<4, true>(batch, w, a, c, b);
      for (b += 4; b + 1 < c; b += 2) choose<2, false>(batch, w, a, c, b);
      if (b < c) choose<1, false>(batch, w, a, c, b);
      const bool is_root = ac == root;
      VKMESH_FOR_LANES(l, kLanes) {
        // The last of a vertex within the surface is an edge that was there.
        const float is_new = (is_root & (batch.closed[l] > 0)) ? 0.0f : 1.0f;
        const float x = batch.left[ac][l];
        const float crossed = is_new * (x > 0 ? w.inside[ac][l] : x < 0 ? w.outside[ac][l] : 0.0f);
        w.best[ac][l] += crossed + is_new * w.of_length[l] * w.distance2[ac][l] + batch.barred[ac][l];
        if constexpr (kAttributes) w.best[ac][l] += attributes->edge[ac][l];
        w.error[ac][l] += crossed;
      }
    }
  VKMESH_FOR_LANES(l, kLanes) {
    const float error = w.base[l] + w.error[root][l] + w.illegal[l];
    batch.error[l] = ((w.best[root][l] < kNone) & (error < kNone)) ? error : kNone;
  }
}

}  // namespace

// Each loop over lanes is one over vector registers.
VKMESH_FLAT_CLONES void retriangulate(RetriangulationBatch& batch, std::size_t neighbours,
                                      float cos_deviation, RetriangulationAttributes* attributes) {
  Work w;
  w.n = neighbours;
  batch.heir.fill(-1);
  scale_ring(batch, w);
  cross_all(w);
  find_faces(batch, w, cos_deviation * std::fabs(cos_deviation));
  find_sides(batch, w);
  if (attributes == nullptr) {
    find_quadric(batch, {batch.ring[neighbours - 1], batch.closed}, w);
    judge_all(batch, w);
    if (batch.shape > 0) add_shapes(batch, w);
    choose_all<false>(batch, w, nullptr);
  } else {
    alignas(64) Vectors to;
    alignas(64) Lanes is_none;
    find_curves(batch, *attributes, to, is_none);
    const Curve curve{to, is_none};
    find_quadric(batch, curve, w);
    find_heirs(batch, curve, w, *attributes);
    judge_all(batch, w);
    if (batch.shape > 0) add_shapes(batch, w);
    judge_attributes(batch, curve, w, *attributes);
    choose_all<true>(batch, w, attributes);
    sum_attributes(batch, w, *attributes);
  }
}

}  // namespace vkmesh::detail
