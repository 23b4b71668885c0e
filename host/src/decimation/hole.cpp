#include "decimation/hole.h"

#include <bit>
#include <cmath>

#include "passes/clones.h"

// A loop over lanes. g++ 12 would unroll a short one before it looks for vectors, and find none.
#if defined(__GNUC__) && !defined(__clang__)
#define VKMESH_LANES(l) _Pragma("GCC unroll 1") for (std::size_t l = 0; l < kLanes; ++l)
#else
#define VKMESH_LANES(l) for (std::size_t l = 0; l < kLanes; ++l)
#endif

namespace vkmesh::detail {
namespace {

constexpr std::size_t kLanes = HoleBatch::kLanes, kMost = HoleBatch::kMost, kPairs = HoleBatch::kPairs;
constexpr std::size_t kTriples = kMost * (kMost - 1) * (kMost - 2) / 6;
using Lanes = HoleBatch::Lanes;
using Flags = std::array<std::int32_t, kLanes>;

/// A triangle of less area than this share of its squared sides has no reliable normal; as in FaceTurns.
constexpr float kDegenerate = 1e-6f;
/// What a new edge counts, for each unit of v's area and of its squared length: it decides where the ground
/// is as good as flat.
constexpr float kOfLength = 1e-7f;
/// Least cosine between a new face and the normal along which all is seen: steeper ones have no reliable
/// height.
constexpr float kSteepest = 0.05f;
/// Heights that are less than this share of the distance to the farthest neighbour may be rounding, and are
/// 0.
constexpr float kRounding = 1.0f / (1 << 21);
constexpr float kNone = std::numeric_limits<float>::infinity();

constexpr std::size_t pair(std::size_t a, std::size_t b) {
  return HoleBatch::pair(a, b);
}
constexpr std::size_t triple(std::size_t a, std::size_t b, std::size_t c) {
  return c * (c - 1) * (c - 2) / 6 + pair(a, b);
}

struct Work {
  std::array<std::array<Lanes, 3>, kMost> ring;    // scaled
  std::array<std::array<Lanes, 3>, kPairs> cross;  // of two neighbours
  std::array<Lanes, kPairs> distance2, crossed, best, error;
  std::array<std::array<Lanes, 3>, kMost> face;  // of v, by the first neighbour: twice its area vector
  std::array<Lanes, kMost> limit, spoke;  // least product with a unit normal, squared; weight of a crossing
  std::array<Lanes, kMost> reliable;      // 0: the face has no reliable normal; else kNone
  std::array<Lanes, kTriples> apart2, at_v, total;
};

}  // namespace

// Each loop over lanes is one over vector registers.
VKMESH_CLONES void fill_holes(HoleBatch& batch, std::size_t n, float cos_deviation) {
  const float square_cos = cos_deviation * std::fabs(cos_deviation);
  Work w;
  alignas(64) std::array<Lanes, 3> up, normal;
  alignas(64) Lanes scale, back2, back4, rounding2, area, along0, along1, along2, base, length2, of_length,
      quarter;
  alignas(64) Lanes illegal, beyond, misfit, without;  // kNone where it is so, else 0

  // Scaled by a power of two, so that no product leaves the range of a float.
  VKMESH_LANES(l) area[l] = 0;
  for (std::size_t i = 0; i < n; ++i) VKMESH_LANES(l) {
      const float x = batch.ring[i][0][l], y = batch.ring[i][1][l], z = batch.ring[i][2][l];
      const float squared = x * x + y * y + z * z;
      area[l] = area[l] > squared ? area[l] : squared;
    }
  VKMESH_LANES(l) {
    const std::int32_t half =
        (static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(area[l]) >> 23) - 127) >> 1;
    rounding2[l] = kRounding * kRounding * area[l];
    scale[l] = std::bit_cast<float>(static_cast<std::uint32_t>(127 - half) << 23);
    const float back = std::bit_cast<float>(static_cast<std::uint32_t>(127 + half) << 23);
    back2[l] = back * back;
    back4[l] = back2[l] * back2[l];
    rounding2[l] *= scale[l] * scale[l];
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < 3; ++k) VKMESH_LANES(l) w.ring[i][k][l] = batch.ring[i][k][l] * scale[l];

  for (std::size_t j = 1; j < n; ++j)
    for (std::size_t i = 0; i < j; ++i) {
      const std::size_t ij = pair(i, j);
      VKMESH_LANES(l) {
        const float ax = w.ring[i][0][l], ay = w.ring[i][1][l], az = w.ring[i][2][l];
        const float bx = w.ring[j][0][l], by = w.ring[j][1][l], bz = w.ring[j][2][l];
        const float dx = bx - ax, dy = by - ay, dz = bz - az;
        w.cross[ij][0][l] = ay * bz - az * by;
        w.cross[ij][1][l] = az * bx - ax * bz;
        w.cross[ij][2][l] = ax * by - ay * bx;
        w.distance2[ij][l] = dx * dx + dy * dy + dz * dz;
      }
    }

  // The faces of v. What is the last where v lies on the boundary, is none, of no area.
  for (std::size_t k = 0; k < 3; ++k) {
    VKMESH_LANES(l) up[k][l] = 0;
    for (std::size_t i = 0; i + 1 < n; ++i) VKMESH_LANES(l) {
        w.face[i][k][l] = w.cross[pair(i, i + 1)][k][l];
        up[k][l] += w.face[i][k][l];
      }
    VKMESH_LANES(l) {
      w.face[n - 1][k][l] = batch.closed[l] * -w.cross[pair(0, n - 1)][k][l];
      up[k][l] += w.face[n - 1][k][l];
    }
  }
  VKMESH_LANES(l) {
    const float size = std::sqrt(up[0][l] * up[0][l] + up[1][l] * up[1][l] + up[2][l] * up[2][l]);
    illegal[l] = size > 0 ? 0.0f : kNone;
    beyond[l] = 0;
    const float over = 1.0f / (size > 0 ? size : 1.0f);
    for (std::size_t k = 0; k < 3; ++k) up[k][l] *= over;
    area[l] = 0;
  }
  for (std::size_t i = 0; i < n; ++i) VKMESH_LANES(l) w.spoke[i][l] = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = i + 1 < n ? i + 1 : 0;
    VKMESH_LANES(l) {
      const float x = w.face[i][0][l], y = w.face[i][1][l], z = w.face[i][2][l];
      const float ax = w.ring[i][0][l], ay = w.ring[i][1][l], az = w.ring[i][2][l];
      const float bx = w.ring[j][0][l], by = w.ring[j][1][l], bz = w.ring[j][2][l];
      const float sides = (ax * ax + ay * ay + az * az) + (bx * bx + by * by + bz * bz);
      const float twice = std::sqrt(x * x + y * y + z * z);
      const float looks = up[0][l] * x + up[1][l] * y + up[2][l] * z;
      const bool reliable = twice > kDegenerate * sides;
      illegal[l] = looks >= -kDegenerate * sides ? illegal[l] : kNone;
      w.limit[i][l] = reliable ? square_cos * (twice * twice) : -1e30f;
      w.reliable[i][l] = reliable ? kNone : 0.0f;
      area[l] += 0.5f * twice;
      quarter[l] = 0.25f * twice;
    }
    for (const std::size_t end : {i, j}) VKMESH_LANES(l) w.spoke[end][l] += quarter[l];
  }
  VKMESH_LANES(l) {
    const float reliable = w.reliable[n - 1][l];
    w.reliable[n - 1][l] = batch.closed[l] > 0 ? reliable : kNone;
  }

  for (std::size_t j = 1; j < n; ++j)
    for (std::size_t i = 0; i < j; ++i) {
      const std::size_t ij = pair(i, j);
      const bool side = j == i + 1;
      VKMESH_LANES(l) {
        const float x =
            up[0][l] * w.cross[ij][0][l] + up[1][l] * w.cross[ij][1][l] + up[2][l] * w.cross[ij][2][l];
        batch.left[ij][l] = side && !(x > 0) ? 0.0f : x;
      }
    }
  const std::size_t root = pair(0, n - 1);
  VKMESH_LANES(l) {
    const float x = batch.left[root][l];
    batch.left[root][l] = ((batch.closed[l] > 0) & (x > 0)) ? 0.0f : x;
  }
  for (std::size_t i = 1; i < n; ++i)  // around once at most
    VKMESH_LANES(l) {
      const float x = batch.left[pair(0, i)][l];
      const float was = beyond[l], before = illegal[l];
      illegal[l] = ((was > 0) & (x > 0)) ? kNone : before;
      beyond[l] = x < 0 ? kNone : was;
    }

  // The quadric along the normal, and on a new boundary edge.
  VKMESH_LANES(l) {
    const float x = up[0][l], y = up[1][l], z = up[2][l];
    const float a0 = batch.a[0][l], a1 = batch.a[1][l], a2 = batch.a[2][l], a3 = batch.a[3][l],
                a4 = batch.a[4][l], a5 = batch.a[5][l];
    const float b0 = batch.b[0][l], b1 = batch.b[1][l], b2 = batch.b[2][l];
    const float back = 1.0f / scale[l];
    const float closed = batch.closed[l];
    along0[l] = closed * batch.c[l];
    along1[l] = closed * (x * b0 + y * b1 + z * b2) * back;
    along2[l] = (x * (a0 * x + 2 * (a1 * y + a2 * z)) + y * (a3 * y + 2 * a4 * z) + a5 * z * z) * back2[l];
    of_length[l] = kOfLength * area[l] * back4[l];
    const float px = batch.ring[0][0][l], py = batch.ring[0][1][l], pz = batch.ring[0][2][l];
    const float dx = batch.ring[n - 1][0][l] - px, dy = batch.ring[n - 1][1][l] - py,
                dz = batch.ring[n - 1][2][l] - pz;
    const float squared = dx * dx + dy * dy + dz * dz;
    const float along = -(px * dx + py * dy + pz * dz) / (squared > 0 ? squared : 1.0f);
    const float t = along > 1 ? 1.0f : along > 0 ? along : 0.0f;
    const float qx = px + t * dx, qy = py + t * dy, qz = pz + t * dz;
    const float q = batch.c[l] + qx * ((a0 * qx + a1 * qy + a2 * qz) + 2 * b0) +
                    qy * ((a1 * qx + a3 * qy + a4 * qz) + 2 * b1) +
                    qz * ((a2 * qx + a4 * qy + a5 * qz) + 2 * b2);
    base[l] = closed > 0 || !(q > 0) ? 0.0f : q;
  }
  for (std::size_t i = 0; i < n; ++i) VKMESH_LANES(l) w.spoke[i][l] *= back4[l];

  for (std::size_t c = 2; c < n; ++c)
    for (std::size_t b = 1; b < c; ++b)
      for (std::size_t a = 0; a < b; ++a) {
        const std::size_t ab = pair(a, b), bc = pair(b, c), ac = pair(a, c), abc = triple(a, b, c);
        const bool is_root = ac == root;
        VKMESH_LANES(l) {
          const float px = w.cross[bc][0][l], py = w.cross[bc][1][l], pz = w.cross[bc][2][l];
          const float nx = w.cross[ab][0][l] + px - w.cross[ac][0][l];
          const float ny = w.cross[ab][1][l] + py - w.cross[ac][1][l];
          const float nz = w.cross[ab][2][l] + pz - w.cross[ac][2][l];
          const float det = w.ring[a][0][l] * px + w.ring[a][1][l] * py + w.ring[a][2][l] * pz;
          const float x1 = batch.left[ab][l], x2 = batch.left[bc][l], x3 = -batch.left[ac][l];
          const float size2 = nx * nx + ny * ny + nz * nz;
          const float sides = w.distance2[ab][l] + w.distance2[bc][l];
          const float looks = x1 + x2 + x3, least = kDegenerate * sides;
          const float whole = (x1 > 0 ? x1 : 0.0f) + (x2 > 0 ? x2 : 0.0f) + (x3 > 0 ? x3 : 0.0f);
          const float height = whole > 0 ? det / whole : 0.0f;
          const float apart = height * height > rounding2[l] ? height : 0.0f;
          const bool holds = (x1 >= 0) & (x2 >= 0) & ((x3 > 0) | (is_root & (x3 >= 0)));
          const float value = along0[l] + apart * (2 * along1[l] + apart * along2[l]);
          const bool has_area = size2 > least * least;
          w.apart2[abc][l] = apart * apart;
          w.at_v[abc][l] = (holds & (value > 0)) ? value : 0.0f;
          normal[0][l] = nx;
          normal[1][l] = ny;
          normal[2][l] = nz;
          length2[l] = has_area ? size2 : 0.0f;
          misfit[l] = (has_area & (looks * std::fabs(looks) < kSteepest * kSteepest * size2)) ? kNone : 0.0f;
          without[l] = has_area ? 0.0f : kNone;
        }
        const auto turns = [&](std::size_t f) {
          VKMESH_LANES(l) {
            const float along = normal[0][l] * w.face[f][0][l] + normal[1][l] * w.face[f][1][l] +
                                normal[2][l] * w.face[f][2][l];
            const float before = misfit[l], none = without[l], reliable = w.reliable[f][l];
            const bool far = along * std::fabs(along) < w.limit[f][l] * length2[l];
            misfit[l] = ((length2[l] > 0) & far) ? kNone : before;
            without[l] = none < reliable ? none : reliable;
          }
        };
        if (b == a + 1) turns(a);
        if (c == b + 1) turns(b);
        if (is_root) turns(n - 1);
        VKMESH_LANES(l) w.total[abc][l] = w.at_v[abc][l] + misfit[l] + without[l];
      }

  // What new edges cost by what they cross.
  for (std::size_t c = 2; c < n; ++c)
    for (std::size_t a = 0; a + 1 < c; ++a) {
      const std::size_t ac = pair(a, c);
      alignas(64) Lanes inside, outside;
      VKMESH_LANES(l) inside[l] = outside[l] = 0;
      for (std::size_t b = a + 1; b < c; ++b)
        VKMESH_LANES(l) inside[l] += w.spoke[b][l] * w.apart2[triple(a, b, c)][l];
      for (std::size_t b = 0; b < a; ++b)
        VKMESH_LANES(l) outside[l] += w.spoke[b][l] * w.apart2[triple(b, a, c)][l];
      for (std::size_t b = c + 1; b < n; ++b)
        VKMESH_LANES(l) outside[l] += w.spoke[b][l] * w.apart2[triple(a, c, b)][l];
      VKMESH_LANES(l) {
        const float x = batch.left[ac][l];
        w.crossed[ac][l] = x > 0 ? inside[l] : x < 0 ? outside[l] : 0.0f;
      }
    }

  // The best of each part between two neighbours.
  for (std::size_t i = 0; i + 1 < n; ++i) VKMESH_LANES(l) {
      w.best[pair(i, i + 1)][l] = 0;
      w.error[pair(i, i + 1)][l] = 0;
    }
  for (std::size_t span = 2; span < n; ++span)
    for (std::size_t a = 0; a + span < n; ++a) {
      const std::size_t c = a + span, ac = pair(a, c);
      alignas(64) Lanes least, error;
      alignas(64) Flags third;
      VKMESH_LANES(l) {
        least[l] = kNone;
        error[l] = 0;
        third[l] = static_cast<std::int32_t>(a + 1);
      }
      for (std::size_t b = a + 1; b < c; ++b) {
        const std::size_t ab = pair(a, b), bc = pair(b, c), abc = triple(a, b, c);
        const auto number = static_cast<std::int32_t>(b);
        VKMESH_LANES(l) {
          const float sum = w.best[ab][l] + w.best[bc][l] + w.total[abc][l];
          const float part = w.error[ab][l] + w.error[bc][l] + w.at_v[abc][l];
          const bool less = sum < least[l];
          least[l] = less ? sum : least[l];
          error[l] = less ? part : error[l];
          third[l] = less ? number : third[l];
        }
      }
      VKMESH_LANES(l) {
        // The last of a vertex within the surface is an edge that was there.
        const bool old = (ac == root) & (batch.closed[l] > 0);
        const float crossed = old ? 0.0f : w.crossed[ac][l];
        const float by_length = old ? 0.0f : of_length[l] * w.distance2[ac][l];
        w.best[ac][l] = least[l] + crossed + by_length + batch.barred[ac][l];
        w.error[ac][l] = error[l] + crossed;
        batch.third[ac][l] = third[l];
      }
    }
  VKMESH_LANES(l) {
    const float error = base[l] + w.error[root][l] + illegal[l];
    batch.error[l] = ((w.best[root][l] < kNone) & (error < kNone)) ? error : kNone;
  }
}

}  // namespace vkmesh::detail
