#include "mesh/edge_matching.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "support/shapes.h"

using namespace vkmesh;
using namespace vkmesh::test;

namespace {

detail::Matching match(const IndexedFaceSet& mesh) {
  return detail::match_edges(mesh.points.size(), mesh.corners, mesh.face_offsets).value();
}

/// Some faces of the mesh, with a copy of its point at some of the corners.
IndexedFaceSet torn(const IndexedFaceSet& whole, std::mt19937& random) {
  IndexedFaceSet mesh;
  mesh.points = whole.points;
  mesh.face_offsets = {0};
  const auto kept = 60 + random() % 41, copied = random() % 30;
  for (std::size_t f = 0; f < whole.face_count(); ++f) {
    if (random() % 100 >= kept) continue;
    for (const std::uint32_t p : whole.face(f)) {
      mesh.corners.push_back(p);
      if (random() % 100 >= copied) continue;
      mesh.corners.back() = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.push_back(whole.points[p]);
    }
    mesh.face_offsets.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  mesh.normalize_offsets();
  return mesh;
}

}  // namespace

TEST_CASE("edges of merged points match as all edges would", "[mesh]") {
  std::mt19937 random(17);
  std::size_t sound = 0, non_manifold = 0, degenerate = 0, fans = 0;
  const std::vector<IndexedFaceSet> shapes = {icosphere(1), torus(7, 5), quad_cube()};
  for (int round = 0; round < 600; ++round) {
    IndexedFaceSet mesh = torn(shapes[static_cast<std::size_t>(round) % shapes.size()], random);
    const detail::Matching before = match(mesh);
    // Copies at one place are merged, most of them, and in every third round two points wherever they are.
    std::vector<std::uint32_t> point_of(mesh.points.size());
    std::vector<Vec3> points;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
      const auto same = std::find(points.begin(), points.end(), mesh.points[p]);
      point_of[p] = static_cast<std::uint32_t>(same - points.begin());
      if (same != points.end() && random() % 8 != 0) continue;
      point_of[p] = static_cast<std::uint32_t>(points.size());
      if (round % 3 == 0 && p > 0 && random() % mesh.points.size() == 0)
        point_of[p] = static_cast<std::uint32_t>(random() % point_of[p]);
      else
        points.push_back(mesh.points[p]);
    }
    mesh.points = points;
    for (std::uint32_t& c : mesh.corners) c = point_of[c];

    const detail::Matching all = match(mesh);
    const auto merged =
        detail::match_merged_edges(before, point_of, points.size(), mesh.corners, mesh.face_offsets);
    REQUIRE(merged.has_value());
    CHECK(merged->twin == all.twin);
    CHECK(merged->leading == all.leading);
    const detail::EdgeDefects &a = merged->defects, &b = all.defects;
    CHECK(a.points == b.points);
    CHECK(a.faces == b.faces);
    CHECK(a.edges == b.edges);
    CHECK(a.boundary_edges == b.boundary_edges);
    CHECK(a.isolated_points == b.isolated_points);
    CHECK(a.degenerate_faces == b.degenerate_faces);
    CHECK(a.non_manifold_edges == b.non_manifold_edges);
    CHECK(a.misoriented_edges == b.misoriented_edges);
    CHECK(a.non_manifold_vertices == b.non_manifold_vertices);
    CHECK(a.sentence == b.sentence);
    if (before.defects.degenerate_faces + before.defects.non_manifold_edges > 0) continue;
    sound += b.none();
    non_manifold += b.non_manifold_edges > 0 && b.degenerate_faces == 0;
    degenerate += b.degenerate_faces > 0;
    fans += b.non_manifold_vertices > 0;
  }
  // Every kind of outcome was met.
  CHECK(sound > 50);
  CHECK(non_manifold > 5);
  CHECK(degenerate > 5);
  CHECK(fans > 20);
}
