// The pass that docs/adding-a-pass.md adds.
#include "example_pass/face_areas.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include "example_pass/record_face_areas.h"
#include "support/device.h"
#include "support/shapes.h"

namespace vkmesh::test {

TEST_CASE("face areas on the device equal the reference bit for bit") {
  IndexedFaceSet set = icosphere(3);
  jitter(set, 0.05f, 1);
  const HalfEdgeMesh mesh = half_edges(set);
  auto device = DeviceMesh::create(test_context(), mesh, set.points);
  REQUIRE(device);
  DeviceArray<float> areas;
  auto recorder = Recorder::create(test_context());
  REQUIRE(recorder);
  REQUIRE(record_face_areas(*recorder, *device, areas));
  REQUIRE(recorder->submit_and_wait());
  const auto found = areas.download(), wanted = face_areas(mesh, set.points);
  REQUIRE(found);
  REQUIRE(wanted);
  CHECK(*found == *wanted);
}

TEST_CASE("face areas are those of the textbook", "[no-device]") {
  const IndexedFaceSet set = torus(20, 12);
  const auto areas = face_areas(half_edges(set), set.points);
  REQUIRE(areas);
  for (std::size_t f = 0; f < areas->size(); ++f) {
    const auto point = [&](std::size_t k) { return DVec3(set.points[set.corners[3 * f + k]]); };
    const double area = 0.5 * glm::length(glm::cross(point(1) - point(0), point(2) - point(0)));
    CHECK((*areas)[f] == Approx(area).epsilon(1e-6));
  }
}

}  // namespace vkmesh::test
