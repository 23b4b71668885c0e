// Area, volume, centroid and bounds against known solids and double precision.
#include <cmath>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/passes/surface_measures.h>

#include "support/shapes.h"
#include "support/vectors.h"

using namespace vkmesh;
using test::area_of;
using test::dot;
using test::length;

TEST_CASE("area, volume, centroid and bounds agree with double precision, wherever the mesh lies") {
  std::vector<IndexedFaceSet> shapes = test::noisy_shapes();
  shapes.push_back(test::double_torus());
  for (const IndexedFaceSet& shape : shapes)
    for (const Vec3 offset : {Vec3(0.0f), Vec3(-3, 5, 20)}) {
      IndexedFaceSet set = shape;
      for (Vec3& p : set.points) p += offset;
      DVec3 low(set.points[0]), high = low;
      for (const Vec3& p : set.points)
        for (int k = 0; k < 3; ++k) {
          low[k] = std::min(low[k], double{p[k]});
          high[k] = std::max(high[k], double{p[k]});
        }
      const DVec3 centre = 0.5 * (low + high);
      double area = 0, volume = 0;
      DVec3 moment(0.0);
      for (std::size_t f = 0; f < set.face_count(); ++f) {
        const auto c = set.face(f);
        const DVec3 p(set.points[c[0]]), q(set.points[c[1]]), r(set.points[c[2]]);
        area += length(area_of(set, f)) / 2;
        volume += dot(p - centre, area_of(set, f)) / 6;
        moment += length(area_of(set, f)) / 6 * (p + q + r);
      }
      const auto found = surface_measures(test::half_edges(set), set.points);
      REQUIRE(found);
      CHECK(DVec3(found->low) == low);
      CHECK(DVec3(found->high) == high);
      // Corners are rounded to 2^-24 of the extent, a part of a triangle's size as large as the mesh is fine;
      // sums take 64 roundings a level at most. Volumes cancel against that of the bounding box.
      const double extent = length(high - low);
      CHECK(std::fabs(found->area / area - 1) < 64 * 0x1p-23);
      CHECK(std::fabs(found->volume - volume) < 64 * 0x1p-23 * area * extent);
      CHECK(length(found->centroid - moment / area) < 64 * 0x1p-23 * extent);
    }
}

TEST_CASE("area, volume and centroid of known solids, of any size; of nothing they are 0") {
  for (const float unit : {1.0f, 0x1p-40f, 0x1p50f}) {
    IndexedFaceSet set = test::cube();
    for (Vec3& p : set.points) p *= unit;
    const SurfaceMeasures cube = surface_measures(test::half_edges(set), set.points).value();
    const double u = unit;
    CHECK(cube.area == 6.0 * u * u);
    CHECK(std::fabs(cube.volume - u * u * u) < 4 * 0x1p-24 * u * u * u);
    CHECK(cube.centroid == DVec3(0.5 * u));
    CHECK((cube.low == Vec3(0.0f) && cube.high == Vec3(unit)));
  }
  IndexedFaceSet set = test::cube();
  for (std::size_t f = 0; f < set.face_count(); ++f) std::swap(set.corners[3 * f], set.corners[3 * f + 1]);
  CHECK(surface_measures(test::half_edges(set), set.points).value().volume < -0.99);
  for (Vec3& p : set.points) p = Vec3(2.0f);
  const SurfaceMeasures point = surface_measures(test::half_edges(set), set.points).value();
  CHECK((point.area == 0.0 && point.volume == 0.0 && point.centroid == DVec3(2.0)));
  const SurfaceMeasures nothing = surface_measures(HalfEdgeMesh{}, {}).value();
  CHECK((nothing.area == 0.0 && nothing.volume == 0.0 && nothing.high == Vec3(0.0f)));
}
