// Holes that vertices leave behind, and how to fill them best.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "simd/lanes.h"

namespace vkmesh::detail {

/// The neighbours of vertices v and the triangles that may take the place of those at v: one vertex a lane,
/// all of the same number of neighbours.
///
/// Seen along the area-weighted normal of v's faces, the old surface and each new one are graphs over the
/// same polygon: their faces must all look up. How far they lie apart is known from the corners of the
/// overlay of both: from v and the point below or above it, and from where edges of v cross new edges. The
/// error of a triangulation is the quadric of v at that point, so that all that v stands for counts, and for
/// each crossing the squared difference of heights times half the area of the faces at the edge of v. That is
/// a sum over new triangles and new edges, so the best of all triangulations is found part by part, each part
/// of the polygon once (G. Klincsek, "Minimal triangulations of polygonal domains", 1980). Among
/// triangulations alike, as of flat ground, that of the shorter edges wins. Where v lies on the boundary, the
/// quadric counts at the point of the new boundary edge nearest to v, and at a point below or above v, where
/// there is one, only what it rises by from v.
///
/// Neighbours a, b, c of which no two have v on the edge between them stand in one of two ways: their
/// triangle holds v, or one's edge of v crosses the new edge of the others. Either way the surfaces lie
/// det(a, b, c) / Σ max(0, X) apart there, where X are twice the signed areas, seen along the normal, of the
/// three triangles with v: nothing but products of neighbours is needed.
///
/// Attributes count as heights do where old and new edges cross: the squared difference of the values of both
/// surfaces. What v stands for is taken over by the corners of the triangle below it, each its barycentric
/// share, and counts there: its mean functions against the values of the corners, with the weight of its
/// wedge, and what is left of their quadrics (see AttributeQuadrics). Where all goes to one corner, that is
/// what a collapse into it costs. Where a seam runs through v, the new edge between its ends is made, and v
/// goes to the nearest point of it, whose ends take over, as a vertex of the boundary does; each side has
/// values and mean functions of its own, and is compared with itself alone.
struct RetriangulationBatch {
  static constexpr std::size_t kLanes = 16;
  static constexpr std::size_t kMaxNeighbours = 16;
  static constexpr std::size_t kPairs = kMaxNeighbours * (kMaxNeighbours - 1) / 2;
  static constexpr float kNone = std::numeric_limits<float>::infinity();
  using Lanes = FloatLanes<kLanes>;

  /// The index of a pair of neighbours a < b.
  [[nodiscard]] static constexpr std::size_t pair(std::size_t a, std::size_t b) {
    return b * (b - 1) / 2 + a;
  }

  // Input. What lies in lanes that were not set does not matter.

  /// Where v is.
  alignas(64) std::array<Lanes, 3> v{};
  /// Where its neighbours are, counter-clockwise.
  alignas(64) std::array<std::array<Lanes, 3>, kMaxNeighbours> ring;
  /// The quadric xᵀA x + 2 b·x + c about v, as VertexRecord has it.
  alignas(64) std::array<Lanes, 6> a;
  alignas(64) std::array<Lanes, 3> b;
  alignas(64) Lanes c;
  /// 1: the faces go all around v; 0: v lies on the boundary between the last neighbour and the first.
  alignas(64) Lanes closed;
  /// The area that v stands for.
  alignas(64) Lanes weight{};
  /// 0; infinite for a new edge that may not be made.
  alignas(64) std::array<Lanes, kPairs> barred{};
  /// Weight of shape, for all lanes: a new triangle of aspect ratio R counts (1 - 1/R) times this, the weight
  /// and the mean of the squared distances of the neighbours from v. It decides between triangulations, and
  /// is no part of the error.
  float shape = 0;

  // Result.

  /// Squared distance times area; infinite when there is no triangulation.
  alignas(64) Lanes error;
  /// Between a and b the neighbour that is the third corner of the triangle at the edge of a and b.
  alignas(64) std::array<std::array<std::int32_t, kLanes>, kPairs> third;
  /// Twice the signed area of v, a and b along the normal: whether v lies left of the edge from a to b.
  alignas(64) std::array<Lanes, kPairs> left;
  /// The neighbour whose fan fills the hole and who takes over all, see fill_with_fan(); else -1.
  alignas(64) std::array<std::int32_t, kLanes> heir;
};

/// What attributes add to the holes of a batch. Differences of values count `cost` times their square.
struct RetriangulationAttributes {
  using Lanes = RetriangulationBatch::Lanes;
  static constexpr std::size_t kMaxNeighbours = RetriangulationBatch::kMaxNeighbours;

  // Input.

  /// The mean function of v's wedge on one side of a seam, and what is there; values less that of v.
  struct OnSide {
    alignas(64) Lanes off{};  // of the mean function at v
    alignas(64) std::array<Lanes, 3> gradient{};
    alignas(64) std::array<Lanes, kMaxNeighbours> ring{};  // of neighbours
  };
  struct Component {
    float cost;
    std::array<OnSide, 2> side;
  };
  std::vector<Component> components;
  /// The weight of v's wedge on each side.
  alignas(64) std::array<Lanes, 2> weight{};
  /// What is left for the best values, as a quadric about v.
  alignas(64) std::array<Lanes, 6> a{};
  alignas(64) std::array<Lanes, 3> b{};
  alignas(64) Lanes c{};
  /// The sides of a seam through v, as SeamSides has them. New edges across it must be barred.
  std::array<std::int32_t, RetriangulationBatch::kLanes> last{}, split{};

  // Result.

  /// What they add to the error, which is without.
  alignas(64) Lanes error{};

  // Where a neighbour takes all over, on each side; of each triangle; of each new edge where v lies left of
  // it, right of it, and what counts.
  alignas(64) std::array<std::array<Lanes, 2>, kMaxNeighbours> receiver{};
  static constexpr std::size_t kTriples = kMaxNeighbours * (kMaxNeighbours - 1) * (kMaxNeighbours - 2) / 6;
  alignas(64) std::array<Lanes, kTriples> at_v{};
  alignas(64) std::array<Lanes, RetriangulationBatch::kPairs> inside{}, outside{}, edge{};
};

/// Finds the best triangulations in which no face turns by more than the angle whose cosine is given; of the
/// same sum with those of attributes, if there are any. O(n³) for n neighbours and each component. The bytes
/// are the same on every machine.
void retriangulate(RetriangulationBatch& batch, std::size_t neighbours, float cos_deviation,
                   RetriangulationAttributes* attributes = nullptr);

}  // namespace vkmesh::detail
