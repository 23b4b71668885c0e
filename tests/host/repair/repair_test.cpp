// consolidate() where it has something to repair.
#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/analysis/topology.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/mesh/triangulate.h>
#include <vkmesh/repair/consolidate.h>

#include "support/data.h"
#include "support/shapes.h"

using namespace vkmesh;

namespace {

/// consolidate(), with what must hold of every result.
Consolidated repaired(const IndexedFaceSet& mesh, const ConsolidateOptions& options = {}) {
  auto result = consolidate(mesh, options);
  if (!result) FAIL(result.error().describe());
  const auto valid = validate(result->mesh);
  if (!valid) FAIL(valid.error().describe());
  const IndexedFaceSet& set = result->face_set;
  CHECK(std::equal(set.corners.begin(), set.corners.end(), result->mesh.origins().begin(),
                   result->mesh.origins().end()));
  CHECK(result->mesh.vertex_count() == set.points.size());
  CHECK(result->mesh.face_count() == set.face_count());
  // The faces alone say the same as the half-edges: nothing is lost by writing them to a file.
  const auto again = diagnose(set);
  REQUIRE(again);
  CHECK(again->manifold());
  // No point moved.
  std::size_t moved = 0;
  for (std::size_t p = 0; p < set.points.size(); ++p)
    moved += set.points[p] != mesh.points[result->source_point.empty() ? p : result->source_point[p]];
  CHECK(moved == 0);
  const ConsolidateReport& report = result->report;
  if (report.repaired_polygons == 0)
    CHECK(set.face_count() ==
          mesh.face_count() - report.removed_degenerate_faces - report.removed_duplicate_faces);
  CHECK(set.points.size() ==
        mesh.points.size() - report.welded_points + report.added_points - report.removed_points);
  return *std::move(result);
}

Topology topology_of(const IndexedFaceSet& mesh) {
  return surface_topology(mesh).value().whole;
}

double volume_of(const IndexedFaceSet& mesh) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto c = mesh.face(f);
    const DVec3 a(mesh.points[c[0]]);
    for (std::size_t i = 1; i + 1 < c.size(); ++i) {
      const DVec3 b(mesh.points[c[i]]), d(mesh.points[c[i + 1]]);
      sum += a.x * (b.y * d.z - b.z * d.y) + a.y * (b.z * d.x - b.x * d.z) + a.z * (b.x * d.y - b.y * d.x);
    }
  }
  return sum / 6;
}

void add_face(IndexedFaceSet& mesh, std::initializer_list<std::uint32_t> face) {
  if (mesh.face_offsets.empty())
    for (std::size_t f = 0; f <= mesh.corners.size() / 3; ++f)
      mesh.face_offsets.push_back(static_cast<std::uint32_t>(3 * f));
  mesh.corners.insert(mesh.corners.end(), face);
  mesh.face_offsets.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
}

}  // namespace

TEST_CASE("a manifold passes unchanged", "[repair]") {
  for (const IndexedFaceSet& mesh : {test::torus(6, 5), test::quad_cube(), test::grid(3, 2)}) {
    const Consolidated result = repaired(mesh);
    CHECK(result.face_set.corners == mesh.corners);
    CHECK(result.source_point.empty());
    CHECK(result.source_face.empty());
    CHECK(result.report.repairs().empty());
  }
}

TEST_CASE("degenerate faces go, and are counted", "[repair]") {
  IndexedFaceSet mesh = test::tetrahedron();
  mesh.corners.insert(mesh.corners.end(), {1, 1, 2, 3, 0, 3});
  const Consolidated result = repaired(mesh);
  CHECK(result.report.removed_degenerate_faces == 2);
  CHECK(result.face_set.face_count() == 4);
  CHECK(result.source_face == std::vector<std::uint32_t>{0, 1, 2, 3});
  CHECK(result.report.repairs() == std::vector<std::string>{"2 faces without three distinct points removed"});
}

TEST_CASE("duplicate faces go: turned about, and reversed where that opens nothing", "[repair]") {
  IndexedFaceSet mesh = test::tetrahedron();
  mesh.corners.insert(mesh.corners.end(), {1, 2, 0});  // Face 0 again.
  mesh.corners.insert(mesh.corners.end(), {2, 1, 0});  // Its reverse.
  const Consolidated result = repaired(mesh);
  CHECK(result.report.removed_duplicate_faces == 2);
  CHECK(result.face_set.corners == test::tetrahedron().corners);
}

TEST_CASE("a sheet and its reverse stay both: nothing says which side is wanted", "[repair]") {
  IndexedFaceSet mesh = test::grid(2, 2);
  const std::size_t faces = mesh.face_count();
  for (std::size_t f = 0; f < faces; ++f)
    mesh.corners.insert(mesh.corners.end(),
                        {mesh.corners[3 * f], mesh.corners[3 * f + 2], mesh.corners[3 * f + 1]});
  const Consolidated result = repaired(mesh);
  CHECK(result.report.removed_duplicate_faces == 0);
  CHECK(result.face_set.face_count() == 2 * faces);
  CHECK(topology_of(result.face_set).closed());
}

TEST_CASE("polygons that repeat a point are repaired", "[repair]") {
  SECTION("in a row: the repetition is left out") {
    IndexedFaceSet mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    add_face(mesh, {0, 1, 1, 2, 3, 0});
    const Consolidated result = repaired(mesh);
    CHECK(result.face_set.corners == std::vector<std::uint32_t>{0, 1, 2, 3});
    CHECK(result.report.repaired_polygons == 1);
  }
  SECTION("a hole joined to the around by a bridge stays a hole") {
    // A square of side 4 with a square hole of side 2, cut along an edge between them.
    IndexedFaceSet mesh;
    mesh.points = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}};
    add_face(mesh, {0, 1, 2, 3, 0, 4, 5, 6, 7, 4});
    const Consolidated result = repaired(mesh);
    CHECK(result.report.repaired_polygons == 1);
    double area = 0;
    for (std::size_t f = 0; f < result.face_set.face_count(); ++f) {
      const auto c = result.face_set.face(f);
      const Vec3 a = result.face_set.points[c[0]], b = result.face_set.points[c[1]],
                 d = result.face_set.points[c[2]];
      area += static_cast<double>((b.x - a.x) * (d.y - a.y) - (b.y - a.y) * (d.x - a.x)) / 2;
    }
    CHECK(area == 12.0);
    const Topology t = topology_of(result.face_set);
    CHECK(t.boundary_loops == 2);
    CHECK(t.genus == 0);
  }
  SECTION("a spike without area goes") {
    IndexedFaceSet mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    add_face(mesh, {0, 1, 0, 1});
    add_face(mesh, {0, 1, 2});
    CHECK(repaired(mesh).face_set.corners == std::vector<std::uint32_t>{0, 1, 2});
  }
}

TEST_CASE("isolated points stay, or go", "[repair]") {
  IndexedFaceSet mesh = test::tetrahedron();
  mesh.points.insert(mesh.points.begin(), Vec3(9.0f));
  for (std::uint32_t& c : mesh.corners) ++c;
  mesh.point_channels = {{"id", 1, std::vector<std::int32_t>{7, 0, 1, 2, 3}}};
  CHECK(repaired(mesh).face_set.points.size() == 5);
  ConsolidateOptions options;
  options.keep_isolated_points = false;
  const Consolidated result = repaired(mesh, options);
  CHECK(result.report.removed_points == 1);
  CHECK(result.source_point == std::vector<std::uint32_t>{1, 2, 3, 4});
  CHECK(result.face_set.corners == test::tetrahedron().corners);
  CHECK(result.face_set.point_channels[0].values == ChannelValues(std::vector<std::int32_t>{0, 1, 2, 3}));
}

TEST_CASE("a point where fans meet is split, attributes with it", "[repair]") {
  IndexedFaceSet mesh = test::bow_tie();
  std::vector<float> heat;
  for (std::size_t p = 0; p < mesh.points.size(); ++p) heat.push_back(static_cast<float>(p));
  mesh.point_channels = {{"heat", 1, heat}};
  const Consolidated result = repaired(mesh);
  CHECK(result.report.split_points == 1);
  CHECK(result.report.added_points == 1);
  CHECK(result.report.non_manifold_vertices == 1);
  CHECK(result.source_point.back() == 0);
  CHECK(std::get<std::vector<float>>(result.face_set.point_channels[0].values).back() == 0.0f);
  CHECK(surface_topology(result.face_set)->components.size() == 2);

  const Consolidated tori = repaired(test::tori_sharing_a_point());
  CHECK(tori.report.added_points == 1);
  CHECK(topology_of(tori.face_set).genus == 2);
}

TEST_CASE("three faces on an edge: the flattest two stay together", "[repair]") {
  // fin(): two coplanar triangles on both sides of the edge, and one that stands up, or hangs down.
  for (const float side : {1.0f, -1.0f}) {
    IndexedFaceSet mesh = test::fin();
    mesh.points[4].z *= side;
    const Consolidated result = repaired(mesh);
    CHECK(result.report.split_edges == 1);
    CHECK(result.report.non_manifold_edges == 1);
    const SurfaceTopology t = surface_topology(result.face_set).value();
    REQUIRE(t.components.size() == 2);
    CHECK(t.components[0].faces == 2);
    CHECK(t.component_of_face[0] == t.component_of_face[1]);
  }
}

TEST_CASE("four faces on an edge: those stay together between which solid lies", "[repair]") {
  // Around the x axis at 0, 90, 180 and 270 degrees; the solid is from 0 to 90 and from 180 to 270, or the
  // rest.
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0.5f, 1, 0}, {0.5f, 0, 1}, {0.5f, -1, 0}, {0.5f, 0, -1}};
  for (const bool other : {false, true}) {
    CAPTURE(other);
    mesh.corners.clear();
    for (std::uint32_t i = 0; i < 4; ++i) {
      if ((i % 2 == 1) != other)
        mesh.corners.insert(mesh.corners.end(), {0, 1, 2 + i});
      else
        mesh.corners.insert(mesh.corners.end(), {1, 0, 2 + i});
    }
    const std::vector<std::uint32_t> of = surface_topology(repaired(mesh).face_set)->component_of_face;
    CHECK(of == (other ? std::vector<std::uint32_t>{0, 1, 1, 0} : std::vector<std::uint32_t>{0, 0, 1, 1}));
  }
}

TEST_CASE("two cubes that touch along an edge become two closed cubes", "[repair]") {
  for (const bool inside_out : {false, true}) {
    CAPTURE(inside_out);
    // The second cube stands diagonally beside the first: edge (1,1,z) in common.
    IndexedFaceSet mesh = test::both(test::cube(), test::cube(), Vec3(1.0f, 1.0f, 0.0f));
    if (inside_out)
      for (std::size_t c = 36; c < mesh.corners.size(); c += 3)
        std::swap(mesh.corners[c], mesh.corners[c + 1]);
    REQUIRE(surface_topology(weld(mesh)->mesh)->whole.non_manifold_edges == 1);
    ConsolidateOptions options;
    options.weld = WeldOptions{};
    const Consolidated result = repaired(mesh, options);
    CHECK(result.report.welded_points == 2);
    const SurfaceTopology t = surface_topology(result.face_set).value();
    REQUIRE(t.components.size() == 2);
    for (const Topology& c : t.components) {
      CHECK(c.closed());
      CHECK(c.genus == 0);
      CHECK(c.faces == 12);
    }
    CHECK(result.report.added_points == 2);
  }
}

TEST_CASE("two cubes that share a wall stay two closed cubes", "[repair]") {
  IndexedFaceSet pair = test::quad_cube();
  const IndexedFaceSet one = test::quad_cube();
  for (const Vec3& p : one.points) pair.points.push_back(p + Vec3(1.0f, 0.0f, 0.0f));
  for (std::size_t f = 0; f < one.face_count(); ++f) {
    for (const std::uint32_t c : one.face(f)) pair.corners.push_back(c + 8);
    pair.face_offsets.push_back(static_cast<std::uint32_t>(pair.corners.size()));
  }
  pair = weld(pair)->mesh;
  REQUIRE(pair.points.size() == 12);
  const Consolidated result = repaired(pair);
  CHECK(result.report.removed_duplicate_faces == 0);
  const SurfaceTopology t = surface_topology(result.face_set).value();
  CHECK(t.components.size() == 2);
  CHECK(t.whole.closed());
  CHECK(volume_of(result.face_set) == Approx(2.0));
}

TEST_CASE("the fewer faces are flipped to agree; of as many, so that a closed component faces outward",
          "[repair]") {
  const IndexedFaceSet sphere = test::icosphere(2);
  const std::size_t faces = sphere.face_count();
  std::mt19937 random(11);
  // Half of them several times, so that the first face, by which the others go, is turned and is not.
  const std::size_t half = faces / 2;
  for (const std::size_t turned : {faces / 3, half, half, half, half, half, half, 2 * faces / 3}) {
    INFO(turned << " of " << faces);
    std::vector<std::size_t> order(faces);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), random);
    IndexedFaceSet mesh = sphere;
    for (std::size_t i = 0; i < turned; ++i)
      std::swap(mesh.corners[3 * order[i] + 1], mesh.corners[3 * order[i] + 2]);
    mesh.corner_channels = {{"corner", 1, std::vector<std::uint32_t>(mesh.corners)}};
    const Consolidated result = repaired(mesh);
    const double volume = volume_of(result.face_set);
    CHECK((2 * turned > faces ? volume < -4.0 : volume > 4.0));
    CHECK(result.report.flipped_faces == std::min(turned, faces - turned));
    CHECK(std::get<std::vector<std::uint32_t>>(result.face_set.corner_channels[0].values) ==
          result.face_set.corners);
  }
}

TEST_CASE("in each of several surfaces the fewer faces turn, whichever they are", "[repair]") {
  std::mt19937 random(23);
  const std::vector<IndexedFaceSet> parts = {test::icosphere(1), test::torus(6, 5), test::grid(4, 3),
                                             test::cylinder(3, 7), test::quad_cube()};
  for (int round = 0; round < 100; ++round) {
    IndexedFaceSet mesh;
    mesh.face_offsets = {0};
    std::size_t fewer = 0;
    std::vector<bool> right;  // Whether each face runs the way of the more.
    for (int n = 0; n < 3; ++n) {
      IndexedFaceSet part = parts[random() % parts.size()];
      if (random() % 2 == 0 && part.is_triangles()) part.corners.resize(part.corners.size() - 3);
      const std::size_t faces = part.face_count();
      std::vector<bool> turned(faces);
      // Often about half of them, so that one face more or less decides.
      const auto share = random() % 2 == 0 ? 50 : random() % 101;
      std::size_t count = 0;
      for (std::size_t f = 0; f < faces; ++f) turned[f] = random() % 100 < share;
      count = static_cast<std::size_t>(std::ranges::count(turned, true));
      if (2 * count == faces)
        turned[0] = !turned[0], count = static_cast<std::size_t>(std::ranges::count(turned, true));
      fewer += std::min(count, faces - count);
      const auto first = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.insert(mesh.points.end(), part.points.begin(), part.points.end());
      for (std::size_t f = 0; f < faces; ++f) {
        std::vector<std::uint32_t> face(part.face(f).begin(), part.face(f).end());
        if (turned[f]) std::reverse(face.begin(), face.end());
        for (const std::uint32_t p : face) mesh.corners.push_back(first + p);
        mesh.face_offsets.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
        right.push_back(turned[f] == (2 * count > faces));
      }
    }
    mesh.normalize_offsets();
    const Consolidated result = repaired(mesh);
    CHECK(result.report.flipped_faces == fewer);
    REQUIRE(result.face_set.face_count() == mesh.face_count());
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const auto before = mesh.face(f), after = result.face_set.face(f);
      // The same cyclic order where it was right, else the reverse of it.
      const auto at = std::ranges::find(after, before[0]) - after.begin();
      const std::size_t n = before.size(), next = (static_cast<std::size_t>(at) + 1) % n;
      CHECK((after[next] == before[1]) == right[f]);
    }
  }
}

TEST_CASE("a cavity with one face turned stays a cavity", "[repair]") {
  IndexedFaceSet mesh = test::cube();
  const IndexedFaceSet outer = mesh;
  for (const Vec3& p : outer.points) mesh.points.push_back(0.25f + 0.5f * p);
  for (std::size_t c = 0; c < outer.corners.size(); c += 3)
    for (const std::size_t k : {0u, 2u, 1u}) mesh.corners.push_back(8 + outer.corners[c + k]);
  const double hollow = volume_of(mesh);
  std::swap(mesh.corners[outer.corners.size()], mesh.corners[outer.corners.size() + 1]);
  const Consolidated result = repaired(mesh);
  CHECK(result.report.flipped_faces == 1);
  CHECK(volume_of(result.face_set) == Approx(hollow));
}

TEST_CASE("a face turned among edges of four faces is turned back", "[repair]") {
  // Four cubes stand on the edges of the top of a fifth; four of the upright edges have four faces, too.
  for (const bool quads : {true, false}) {
    const IndexedFaceSet one = quads ? test::quad_cube() : test::cube();
    IndexedFaceSet five;
    for (const Vec3 offset : {Vec3(0, 0, 0), Vec3(1, 0, 1), Vec3(-1, 0, 1), Vec3(0, 1, 1), Vec3(0, -1, 1)}) {
      const auto first = static_cast<std::uint32_t>(five.points.size());
      for (const Vec3& p : one.points) five.points.push_back(p + offset);
      for (const std::uint32_t c : one.corners) five.corners.push_back(first + c);
    }
    for (std::uint32_t c = 0; quads && c <= five.corners.size(); c += 4) five.face_offsets.push_back(c);
    five = weld(five).value().mesh;
    const Consolidated sound = repaired(five);
    CHECK(sound.report.flipped_faces == 0);
    CHECK(std::abs(volume_of(sound.face_set) - 5) < 1e-6);

    std::size_t turned = 0;
    for (std::size_t f = 0; f < one.face_count(); ++f) {
      const auto face = five.face(f);
      if (!std::ranges::all_of(face, [&](std::uint32_t p) { return five.points[p].z == 1; })) continue;
      std::reverse(five.corners.begin() + (face.data() - five.corners.data()),
                   five.corners.begin() + (face.data() - five.corners.data()) +
                       static_cast<std::ptrdiff_t>(face.size()));
      ++turned;
    }
    REQUIRE(turned == (quads ? 1 : 2));
    const Consolidated mended = repaired(five);
    CHECK(mended.report.flipped_faces == turned);
    CHECK(topology_of(mended.face_set).boundary_loops == 0);
    CHECK(std::abs(volume_of(mended.face_set) - 5) < 1e-6);
  }
}

TEST_CASE("a consistent surface that faces inward is left so: it may be a room", "[repair]") {
  IndexedFaceSet mesh = test::both(test::icosphere(1), test::bow_tie(), Vec3(9.0f));
  for (std::size_t c = 0; c < 3 * 80; c += 3) std::swap(mesh.corners[c], mesh.corners[c + 1]);
  CHECK(repaired(mesh).report.flipped_faces == 0);
  // Nor does it turn because another component has to.
  std::swap(mesh.corners[3 * 80], mesh.corners[3 * 80 + 1]);
  const Consolidated result = repaired(mesh);
  CHECK(result.report.flipped_faces == 1);
  CHECK(std::equal(mesh.corners.begin(), mesh.corners.begin() + 3 * 80, result.face_set.corners.begin()));
}

TEST_CASE("an open sheet keeps the orientation of its larger part", "[repair]") {
  IndexedFaceSet mesh = test::grid(4, 4);
  for (const std::size_t f : {0u, 9u, 20u}) std::swap(mesh.corners[3 * f], mesh.corners[3 * f + 2]);
  const Consolidated result = repaired(mesh);
  CHECK(result.report.flipped_faces == 3);
  for (std::size_t f = 0; f < result.face_set.face_count(); ++f) {
    const auto c = result.face_set.face(f);
    const Vec3 a = result.face_set.points[c[0]], b = result.face_set.points[c[1]],
               d = result.face_set.points[c[2]];
    CHECK((b.x - a.x) * (d.y - a.y) - (b.y - a.y) * (d.x - a.x) > 0);
  }
}

TEST_CASE("what is not orientable is cut open along a seam, or refused", "[repair]") {
  const Consolidated strip = repaired(test::mobius(9));
  CHECK(strip.report.cut_components == 1);
  CHECK(strip.report.cut_edges == 1);
  CHECK(strip.report.added_points == 2);
  const Topology t = topology_of(strip.face_set);
  CHECK(t.genus == 0);
  CHECK(t.boundary_loops == 1);

  for (const auto& [rings, sides] : {std::pair{3u, 3u}, std::pair{8u, 6u}, std::pair{5u, 12u}}) {
    const Consolidated bottle = repaired(test::klein_bottle(rings, sides));
    CHECK(bottle.report.cut_components == 1);
    CHECK(bottle.report.cut_edges >= sides);
    CHECK(topology_of(bottle.face_set).orientable);
    CHECK_FALSE(topology_of(bottle.face_set).closed());
  }

  ConsolidateOptions options;
  options.cut_non_orientable = false;
  const auto refused = consolidate(test::both(test::torus(5, 4), test::mobius(9), Vec3(9.0f)), options);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::kUnsuitable);
  CHECK_THAT(refused.error().message, Catch::Contains("the component of face 40 is not orientable"));
}

TEST_CASE("strict refuses what would be repaired", "[repair]") {
  ConsolidateOptions strict;
  strict.strict = true;
  CHECK(consolidate(test::torus(5, 4), strict));
  for (const IndexedFaceSet& mesh : {test::fin(), test::bow_tie(), test::mobius(9)}) {
    const auto result = consolidate(mesh, strict);
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::kUnsuitable);
  }
}

TEST_CASE("welding comes first, and its seams survive", "[repair]") {
  // A cube as six quads that share no points, each with texture coordinates of its own.
  IndexedFaceSet soup;
  const IndexedFaceSet cube = test::quad_cube();
  std::vector<float> uv;
  soup.face_offsets = {0};
  for (std::size_t f = 0; f < 6; ++f) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      soup.corners.push_back(static_cast<std::uint32_t>(soup.points.size()));
      soup.points.push_back(cube.points[cube.face(f)[i]]);
      uv.insert(uv.end(), {static_cast<float>(i / 2), static_cast<float>(f)});
    }
    soup.face_offsets.push_back(static_cast<std::uint32_t>(soup.corners.size()));
  }
  soup.point_channels = {{"uv", 2, uv}};
  ConsolidateOptions options;
  options.weld = WeldOptions{};
  const Consolidated result = repaired(soup, options);
  CHECK(result.report.welded_points == 16);
  CHECK(result.report.weld_seams == std::vector<std::string>{"uv"});
  CHECK(topology_of(result.face_set).genus == 0);
  CHECK(result.face_set.point_channels.empty());
  REQUIRE(result.face_set.corner_channels.size() == 1);
  CHECK(result.face_set.corner_channels[0].values == ChannelValues(uv));
  CHECK(result.source_point.size() == 8);
  for (std::size_t p = 0; p < 8; ++p) CHECK(result.face_set.points[p] == soup.points[result.source_point[p]]);
}

TEST_CASE("random soups of triangles over few points become manifolds, faces all accounted for", "[repair]") {
  std::mt19937 generator(2024);
  const auto random = [&] { return static_cast<std::uint32_t>(generator()); };
  for (int run = 0; run < 400; ++run) {
    CAPTURE(run);
    IndexedFaceSet mesh;
    const std::uint32_t points = 4 + random() % 9, faces = 1 + random() % 40;
    for (std::uint32_t p = 0; p < points; ++p)
      mesh.points.emplace_back(static_cast<float>(random() % 16), static_cast<float>(random() % 16),
                               static_cast<float>(random() % 16));
    mesh.face_offsets = {0};
    for (std::uint32_t f = 0; f < faces; ++f) {
      const std::uint32_t size = run % 2 == 0 ? 3 : 3 + random() % 4;
      for (std::uint32_t i = 0; i < size; ++i) mesh.corners.push_back(random() % points);
      mesh.face_offsets.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    }
    mesh.normalize_offsets();
    const Consolidated result = repaired(mesh);
    // Every face of the result has the points of its source, in its order or the reverse.
    for (std::size_t f = 0; f < result.face_set.face_count() && result.report.repaired_polygons == 0; ++f) {
      const std::size_t source = result.source_face.empty() ? f : result.source_face[f];
      std::multiset<std::uint32_t> ours, theirs(mesh.face(source).begin(), mesh.face(source).end());
      for (const std::uint32_t c : result.face_set.face(f))
        ours.insert(result.source_point.empty() ? c : result.source_point[c]);
      CHECK(ours == theirs);
    }
  }
}

TEST_CASE("every mesh of libcgal-demo consolidates into a valid manifold", "[repair][data]") {
  std::size_t whole = 0, defective = 0;
  for (const auto& path : test::cgal_meshes()) {
    auto file = read_mesh(path);
    if (!file) {
      // Point files of formats that are no meshes.
      CAPTURE(path, file.error().describe());
      CHECK(path.parent_path().filename() == "points_3");
      continue;
    }
    CAPTURE(path);
    const IndexedFaceSet mesh = to_indexed_face_set(std::move(*file)).value();
    const Consolidated result = repaired(mesh);
    ++whole;
    defective += result.report.manifold() ? 0u : 1u;
  }
  CHECK(whole >= 150);
  CHECK(defective >= 6);
}
