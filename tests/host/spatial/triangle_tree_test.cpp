// The nearest triangle against a look at every triangle.
#include "spatial/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <catch2/catch.hpp>

#include "math/triangle_distance.h"
#include "support/shapes.h"

using namespace vkmesh;

TEST_CASE("tree of triangles: the nearest is that of a search through all triangles", "[spatial]") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-2, 2);
  for (const IndexedFaceSet& mesh : {test::tetrahedron(), test::torus(16, 9), test::grid(7, 5)}) {
    const detail::TriangleTree tree(mesh.points, mesh.corners);
    std::uint32_t hint = 0;
    for (int i = 0; i < 200; ++i) {
      const DVec3 p(place(random), place(random), place(random));
      double wanted = std::numeric_limits<double>::infinity();
      for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const auto c = mesh.face(f);
        wanted = std::min(
            wanted, detail::squared_distance(
                        p, {DVec3(mesh.points[c[0]]), DVec3(mesh.points[c[1]]), DVec3(mesh.points[c[2]])}));
      }
      // Where triangles share the nearest point their distances differ by rounding, and so do those of boxes.
      const double found = tree.nearest(p, hint);
      CHECK(std::abs(found - wanted) <= 1e-12 * wanted);
      CHECK(std::abs(found - detail::squared_distance(p, tree.at(hint))) <= 1e-12 * wanted);
    }
  }
}
