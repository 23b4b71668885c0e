#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/repair/consolidate.h>

#include "mesh/edge_matching.h"
#include "repair/weld_boundary.h"
#include "support/asking_clock.h"
#include "support/shapes.h"

using namespace vkmesh;

namespace {

ConsolidateReport report_of(const IndexedFaceSet& mesh) {
  const auto report = diagnose(mesh);
  if (!report) FAIL(report.error().describe());
  return *report;
}

}  // namespace

TEST_CASE("consolidate keeps the numbering: vertex i is point i, half-edge i corner i") {
  const IndexedFaceSet set = test::torus(7, 5);
  const auto result = consolidate(set);
  REQUIRE(result);
  CHECK(std::equal(set.corners.begin(), set.corners.end(), result->mesh.origins().begin()));
  CHECK(result->report.manifold());
  CHECK(result->report.defects.empty());
  CHECK(result->report.edges == 105);
  CHECK(result->report.boundary_edges == 0);
}

TEST_CASE("consolidate finds the same twins as comparing all pairs of edges") {
  IndexedFaceSet set = test::cylinder(3, 6);
  std::mt19937 random(5);
  // In a random order of faces and points.
  std::vector<std::uint32_t> name(set.points.size());
  for (std::uint32_t i = 0; i < name.size(); ++i) name[i] = i;
  for (std::size_t i = name.size() - 1; i > 0; --i) std::swap(name[i], name[random() % (i + 1)]);
  for (auto& c : set.corners) c = name[c];
  for (std::size_t f = set.face_count() - 1; f > 0; --f) {
    const std::size_t g = random() % (f + 1);
    for (std::size_t i = 0; i < 3; ++i) std::swap(set.corners[3 * f + i], set.corners[3 * g + i]);
  }
  const HalfEdgeMesh mesh = test::half_edges(set);
  CHECK(validate(mesh));
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    std::uint32_t expected = kInvalid;
    for (std::uint32_t g = 0; g < mesh.half_edge_count(); ++g)
      if (mesh.origin(HalfEdgeId(g)) == mesh.target(HalfEdgeId(h)) &&
          mesh.target(HalfEdgeId(g)) == mesh.origin(HalfEdgeId(h)))
        expected = g;
    CHECK(mesh.twins()[h] == expected);
  }
}

TEST_CASE("a vertex of high valence is sorted right") {
  // A cone over 100 points: the apex has more records than the sorting network takes.
  IndexedFaceSet set;
  set.points.assign(101, Vec3(0.0f));
  for (std::uint32_t i = 0; i < 100; ++i)
    set.corners.insert(set.corners.end(), {0, 1 + i, 1 + (i + 37) % 100});
  const auto result = consolidate(set);
  REQUIRE(result);
  CHECK(validate(result->mesh));
  CHECK(result->report.edges == 200);
  CHECK(result->report.boundary_edges == 100);
}

TEST_CASE("each defect is refused with its count and first element") {
  SECTION("three faces on an edge") {
    const auto result = to_half_edge_mesh(test::fin());
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::kUnsuitable);
    CHECK_THAT(result.error().message, Catch::Contains("1 edge with three or more faces (points 0 and 1)"));
    CHECK(report_of(test::fin()).non_manifold_edges == 1);
  }
  SECTION("separate fans at a point") {
    const auto result = to_half_edge_mesh(test::bow_tie());
    REQUIRE_FALSE(result);
    CHECK_THAT(result.error().message,
               Catch::Contains("1 point where separate fans of faces meet (point 0)"));
  }
  SECTION("faces that disagree in orientation") {
    IndexedFaceSet set = test::tetrahedron();
    std::swap(set.corners[0], set.corners[1]);
    const ConsolidateReport report = report_of(set);
    CHECK(report.misoriented_edges == 3);
    CHECK_THAT(report.defects,
               Catch::Contains("3 edges whose two faces disagree in orientation (first: points 0 and 1)"));
    CHECK_FALSE(to_half_edge_mesh(set));
  }
  SECTION("a Möbius strip, which no orientation serves") {
    CHECK(report_of(test::mobius(9)).misoriented_edges == 1);
    CHECK_FALSE(to_half_edge_mesh(test::mobius(9)));
  }
  SECTION("a face that repeats a point") {
    IndexedFaceSet set = test::quad_cube();
    set.corners[2] = set.corners[0];
    const ConsolidateReport report = report_of(set);
    CHECK(report.degenerate_faces == 1);
    CHECK_THAT(report.defects, Catch::StartsWith("1 degenerate face (face 0)"));
    CHECK_FALSE(to_half_edge_mesh(set));
  }
  SECTION("a face of two corners") {
    IndexedFaceSet set = test::quad_cube();
    set.corners.insert(set.corners.end(), {0, 1});
    set.face_offsets.push_back(26);
    CHECK(report_of(set).degenerate_faces == 1);
  }
}

TEST_CASE("isolated points and boundaries are counted, not refused") {
  IndexedFaceSet set = test::grid(3, 2);
  set.points.resize(set.points.size() + 4, Vec3(0.0f));
  const auto result = consolidate(set);
  REQUIRE(result);
  CHECK(result->report.isolated_points == 4);
  CHECK(result->report.boundary_edges == 10);
  CHECK(result->report.edges == 23);
  set.corners.insert(set.corners.end(), {0, 0, 1});
  CHECK(report_of(set).isolated_points == 4);
}

TEST_CASE("an empty mesh and a point cloud consolidate into meshes without faces") {
  const auto nothing = consolidate(IndexedFaceSet{});
  REQUIRE(nothing);
  CHECK(validate(nothing->mesh));
  CHECK(nothing->mesh.face_count() == 0);
  IndexedFaceSet cloud;
  cloud.points.assign(5, Vec3(1.0f));
  const auto result = consolidate(cloud);
  REQUIRE(result);
  CHECK(validate(result->mesh));
  CHECK(result->report.isolated_points == 5);
}

TEST_CASE("corners that name no point and offsets that do not ascend are usage errors") {
  IndexedFaceSet set = test::tetrahedron();
  set.corners[4] = 4;
  REQUIRE_FALSE(consolidate(set));
  CHECK(consolidate(set).error().code == ErrorCode::kUsage);
  CHECK_THAT(consolidate(set).error().message, Catch::Contains("names point 4, but there are 4 points"));
  set = test::quad_cube();
  set.face_offsets[3] = 4;
  CHECK(consolidate(set).error().code == ErrorCode::kUsage);
  set = test::tetrahedron();
  set.corners.pop_back();
  CHECK(consolidate(set).error().code == ErrorCode::kUsage);
}

TEST_CASE("welding and the search for neighbours ask all along, and end where they are told to") {
  const IndexedFaceSet set = test::grid(256, 256);
  const auto done = [](const auto& result, const detail::Stop& stop) {
    CHECK(result.has_value() == !stop.is_set());
    if (!result) CHECK(result.error().code == ErrorCode::kInterrupted);
  };
  test::check_asks(16, [&](detail::Stop& stop) {
    done(detail::match_edges(set.points.size(), set.corners, set.face_offsets, &stop), stop);
  });
  test::check_asks(4, [&](detail::Stop& stop) { done(detail::weld_boundary(set, {}, &stop), stop); });
  for (const double tolerance : {0.0, 0.25})
    test::check_asks(
        4, [&](detail::Stop& stop) { done(detail::weld(set, {Length::absolute(tolerance)}, &stop), stop); });
}

TEST_CASE("consolidation can be cancelled at any report, of input that needs no repair, too") {
  for (const IndexedFaceSet& set : {test::torus(7, 5), test::quad_cube(), test::fin(), test::bow_tie()})
    for (const bool weld : {false, true}) {
      ConsolidateOptions options;
      if (weld) options.weld.emplace();
      int reports = 0;
      double last = 0;
      REQUIRE(consolidate(set, options, [&](double fraction) {
        CHECK(fraction >= last);
        last = fraction;
        return ++reports > 0;
      }));
      CHECK(last == 1);
      REQUIRE(reports > 2);
      for (int stop = 1; stop <= reports; ++stop) {
        int seen = 0;
        const auto result = consolidate(set, options, [&](double) { return ++seen < stop; });
        REQUIRE_FALSE(result);
        CHECK(result.error().code == ErrorCode::kInterrupted);
      }
    }
}

namespace {

/// The faces of a torus over points that are repeated along two of its circles, with a value for each copy.
IndexedFaceSet split_torus() {
  IndexedFaceSet mesh = test::torus(12, 9);
  std::vector<float> u(mesh.corners.size());
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (std::size_t c = 3 * f; c < 3 * f + 3; ++c) u[c] = f / 2 % 9 < 4 ? 0.0f : 1.0f;
  mesh.corner_channels = {{"u", 1, u}};
  const std::vector<std::string> names = {"u"};
  return split_at_seams(mesh, names).value();
}

}  // namespace

TEST_CASE("weld_boundary closes seams, and leaves alone what is closed") {
  const IndexedFaceSet split = split_torus();
  REQUIRE(report_of(split).boundary_edges > 0);
  const std::size_t copies = split.points.size() - 12 * 9;

  const auto open = consolidate(split);
  REQUIRE(open);
  CHECK(open->report.boundary_edges > 0);
  CHECK(open->report.welded_points == 0);

  const auto closed = consolidate(split, {.weld_boundary = true});
  REQUIRE(closed);
  CHECK(closed->report.boundary_edges == 0);
  CHECK(closed->report.welded_points == copies);
  CHECK(closed->report.weld_seams == std::vector<std::string>{"u"});
  CHECK(closed->face_set.points.size() == 12 * 9);
  REQUIRE(closed->source_point.size() == 12 * 9);
  for (std::size_t p = 0; p < closed->source_point.size(); ++p)
    REQUIRE(closed->face_set.points[p] == split.points[closed->source_point[p]]);

  // Also where a degenerate face stands between the others.
  IndexedFaceSet with_needle = split;
  with_needle.corners.insert(with_needle.corners.begin() + 30, {0, 0, 1});
  for (Channel& channel : with_needle.point_channels) REQUIRE(channel.scalar_count() == split.points.size());
  const auto mended = consolidate(with_needle, {.weld_boundary = true});
  REQUIRE(mended);
  CHECK(mended->report.removed_degenerate_faces == 1);
  CHECK(mended->mesh.half_edge_count() == split.corners.size());
  CHECK(std::ranges::count(mended->mesh.twins(), kInvalid) == 0);

  // Two cubes that stand on one corner, and a sheet beside whose points lie on theirs.
  IndexedFaceSet cubes = test::both(test::cube(), test::cube(), {1, 1, 1});
  const std::size_t points = cubes.points.size();
  const auto apart = consolidate(cubes, {.weld_boundary = true});
  REQUIRE(apart);
  CHECK(apart->report.manifold());
  CHECK(apart->report.welded_points == 0);
  cubes.points.insert(cubes.points.end(), {{1, 1, 1}, {2, 1, 1}, {2, 2, 1}});
  for (const std::uint32_t p : {0u, 1u, 2u}) cubes.corners.push_back(static_cast<std::uint32_t>(points) + p);
  const auto beside = consolidate(cubes, {.weld_boundary = true});
  REQUIRE(beside);
  CHECK(beside->report.welded_points == 0);
  CHECK(consolidate(cubes, {.weld = WeldOptions{}})->report.welded_points > 0);
}

TEST_CASE("weld_boundary joins what a search over all pairs of points joins") {
  std::mt19937 random(21);
  std::size_t welded = 0, still_open = 0;
  for (int round = 0; round < 200; ++round) {
    // A closed surface without some of its faces, with copies of points at some corners.
    const IndexedFaceSet whole = round % 2 == 0 ? test::icosphere(1) : test::torus(7, 5);
    IndexedFaceSet mesh;
    mesh.points = whole.points;
    const auto dropped = random() % 2 * 5, copied = random() % 40;
    for (std::size_t f = 0; f < whole.face_count(); ++f) {
      if (random() % 100 < dropped) continue;
      for (const std::uint32_t p : whole.face(f)) {
        mesh.corners.push_back(p);
        if (random() % 100 >= copied) continue;
        mesh.corners.back() = static_cast<std::uint32_t>(mesh.points.size());
        mesh.points.push_back(whole.points[p]);
      }
    }
    const auto edges_of = [&](const auto& number) {
      std::map<std::pair<std::size_t, std::size_t>, int> uses;
      for (std::size_t c = 0; c < mesh.corners.size(); c += 3)
        for (std::size_t i = 0; i < 3; ++i)
          ++uses[std::minmax<std::size_t>(number[mesh.corners[c + i]],
                                          number[mesh.corners[c + (i + 1) % 3]])];
      return uses;
    };
    std::vector<std::size_t> number(mesh.points.size());
    std::iota(number.begin(), number.end(), std::size_t{0});
    std::set<std::size_t> open;
    for (const auto& [edge, uses] : edges_of(number))
      if (uses == 1) open.insert({edge.first, edge.second});
    std::size_t joined = 0;
    for (const std::size_t p : open)
      for (const std::size_t q : open) {
        if (mesh.points[q] != mesh.points[p]) continue;
        number[p] = q;
        joined += q < p;
        break;
      }
    const auto after = edges_of(number);
    const auto closed = consolidate(mesh, {.weld_boundary = true});
    REQUIRE(closed);
    CHECK(closed->report.welded_points == joined);
    CHECK(closed->report.edges == after.size());
    CHECK(closed->report.boundary_edges == static_cast<std::size_t>(std::ranges::count_if(
                                               after, [](const auto& e) { return e.second == 1; })));
    welded += joined;
    still_open += closed->report.boundary_edges;
  }
  CHECK(welded > 1000);
  CHECK(still_open > 100);
}
