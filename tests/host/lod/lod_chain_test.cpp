// Chains of levels of detail: what each level keeps, how near it is, and the vertex buffer that they share.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/analysis/topology.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/lod/lod_chain.h>
#include <vkmesh/repair/consolidate.h>

#include "support/data.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

constexpr DecimateOperation kLodOperations[] = {DecimateOperation::kEdgeCollapse,
                                                DecimateOperation::kHalfEdgeCollapse,
                                                DecimateOperation::kVertexRemoval};

LodVertices vertices_for(DecimateOperation operation) {
  return operation == DecimateOperation::kEdgeCollapse ? LodVertices::kOwn : LodVertices::kShared;
}

TriangleSurface surface_of(const IndexedFaceSet& mesh) {
  return {mesh.points, mesh.corners};
}
TriangleSurface surface_of(const LodLevel& level) {
  return {level.positions, level.mesh.origins()};
}

LodChain chain_of(const IndexedFaceSet& mesh, const LodChainOptions& options) {
  auto chain = lod_chain(surface_of(mesh), options);
  if (!chain) FAIL(chain.error().describe());
  for (const LodLevel& level : chain->levels)
    if (const auto valid = validate(level.mesh); !valid) FAIL(valid.error().describe());
  return std::move(*chain);
}

/// Corners with (x, y), moved by 10 on the faces of the upper half: a seam lies between the halves.
struct TwoCharts {
  IndexedFaceSet mesh;
  std::vector<float> values;
  std::vector<std::uint32_t> corners;

  explicit TwoCharts(IndexedFaceSet of) : mesh(std::move(of)) {
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      float height = 0;
      for (const std::uint32_t v : mesh.face(f)) height += mesh.points[v].z;
      for (const std::uint32_t v : mesh.face(f)) {
        corners.push_back(static_cast<std::uint32_t>(corners.size()));
        values.push_back(mesh.points[v].x + (height > 0 ? 10.0f : 0.0f));
        values.push_back(mesh.points[v].y);
      }
    }
  }
  [[nodiscard]] DecimateAttribute attribute() const {
    DecimateAttribute uv;
    uv.components = 2;
    uv.values = values;
    uv.corners = corners;
    return uv;
  }
};

/// Triangles by the values of their corners, each rotated to its least corner.
std::vector<std::vector<float>> triangles_by_value(std::span<const std::uint32_t> corners,
                                                   const std::vector<Vec3>& points) {
  std::vector<std::vector<float>> all;
  for (std::size_t c = 0; c < corners.size(); c += 3) {
    std::array<std::array<float, 3>, 3> t;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& p = points[corners[c + i]];
      t[i] = {p.x, p.y, p.z};
    }
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::vector<float> flat;
    for (const auto& corner : t) flat.insert(flat.end(), corner.begin(), corner.end());
    all.push_back(std::move(flat));
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// That each level has the first of the vertices and wedges of the level before.
void check_prefixes(const LodChain& chain) {
  for (std::size_t k = 1; k < chain.levels.size(); ++k) {
    const LodLevel &fine = chain.levels[k - 1], &coarse = chain.levels[k];
    REQUIRE(coarse.positions.size() < fine.positions.size());
    CHECK(std::equal(coarse.positions.begin(), coarse.positions.end(), fine.positions.begin()));
    CHECK(std::equal(coarse.source_vertex.begin(), coarse.source_vertex.end(), fine.source_vertex.begin()));
    for (const std::uint32_t v : coarse.mesh.origins()) REQUIRE(v < coarse.positions.size());
    const auto &a = fine.attributes, &b = coarse.attributes;
    REQUIRE(b.source_corner.size() <= a.source_corner.size());
    CHECK(std::equal(b.source_corner.begin(), b.source_corner.end(), a.source_corner.begin()));
    for (std::size_t i = 0; i < b.values.size(); ++i)
      CHECK(std::equal(b.values[i].begin(), b.values[i].end(), a.values[i].begin()));
    for (const std::uint32_t w : b.corners) REQUIRE(w < b.source_corner.size());
  }
}

void check_topology(const IndexedFaceSet& mesh, const LodChain& chain) {
  const HalfEdgeMesh input = test::half_edges(mesh);
  const auto euler = [](const HalfEdgeMesh& m) {
    return static_cast<std::ptrdiff_t>(m.vertex_count()) - static_cast<std::ptrdiff_t>(m.edge_count()) +
           static_cast<std::ptrdiff_t>(m.face_count());
  };
  for (const LodLevel& level : chain.levels) {
    CHECK(euler(level.mesh) == euler(input));
    CHECK(level.mesh.boundary_loops().size() == input.boundary_loops().size());
  }
}

}  // namespace

TEST_CASE("Levels have as many faces as asked, the input's topology, and errors that rise", "[lod]") {
  for (const IndexedFaceSet& mesh : {test::icosphere(4), test::torus(48, 24), test::cylinder(30, 40)})
    for (const DecimateOperation operation : kLodOperations) {
      LodChainOptions options;
      options.ratios = {0.5, 0.2, 0.05};
      options.decimate.operation = operation;
      options.vertices = vertices_for(operation);
      const LodChain chain = chain_of(mesh, options);
      REQUIRE(chain.levels.size() == 4);
      CHECK(chain.last.stop == DecimateStop::kTargetReached);
      CHECK(triangles_by_value(chain.levels[0].mesh.origins(), chain.levels[0].positions) ==
            triangles_by_value(mesh.corners, mesh.points));
      check_topology(mesh, chain);
      for (std::size_t k = 1; k < 4; ++k) {
        const LodLevel& level = chain.levels[k];
        const double asked = options.ratios[k - 1] * static_cast<double>(mesh.face_count());
        CHECK(static_cast<double>(level.mesh.face_count()) <= asked + 1);
        CHECK(static_cast<double>(level.mesh.face_count()) >= asked - 2);
        CHECK(level.error >= chain.levels[k - 1].error);
        CHECK(level.collapses > chain.levels[k - 1].collapses);
        // The map leads from the vertices of the level before to all of this one.
        REQUIRE(level.vertex_map.size() == chain.levels[k - 1].positions.size());
        std::vector<bool> reached(level.positions.size());
        for (const std::uint32_t v : level.vertex_map) reached.at(v) = true;
        CHECK(std::find(reached.begin(), reached.end(), false) == reached.end());
        for (std::uint32_t v = 0; v < level.vertex_map.size(); ++v)
          if (options.vertices == LodVertices::kShared && v < level.positions.size())
            CHECK(level.vertex_map[v] == v);
      }
      if (options.vertices == LodVertices::kShared) check_prefixes(chain);
    }
}

TEST_CASE("A level of a chain is as near to the input as a decimation straight to it", "[lod]") {
  std::vector<double> ratios;
  for (const IndexedFaceSet& mesh : test::noisy_shapes())
    for (const DecimateOperation operation : kLodOperations) {
      LodChainOptions options;
      options.count = 4;
      options.decimate.operation = operation;
      const LodChain chain = chain_of(mesh, options);
      REQUIRE(chain.levels.size() >= 2);  // the cube has no more than three
      for (std::size_t k = 1; k < chain.levels.size(); ++k) {
        DecimateOptions straight = options.decimate;
        straight.target.faces = chain.levels[k].mesh.face_count();
        const Decimated alone = decimate(surface_of(mesh), straight).value();
        const auto mean = [&](const TriangleSurface& s) {
          SurfaceDistanceOptions few;
          few.samples = 4000;
          return surface_distance(surface_of(mesh), s, few).value().two_sided().mean;
        };
        ratios.push_back(mean(surface_of(chain.levels[k])) / mean({alone.positions, alone.mesh.origins()}));
        CHECK(ratios.back() < 1.25);
      }
    }
  double sum = 0;
  for (const double r : ratios) sum += r;
  CHECK(sum / static_cast<double>(ratios.size()) < 1.05);
}

TEST_CASE("The bound that levels tell holds, and what is measured lies below it", "[lod]") {
  for (const DecimateOperation operation : kLodOperations) {
    LodChainOptions options;
    options.count = 4;
    options.decimate.operation = operation;
    options.decimate.bounds.report_distance = true;
    options.measure = true;
    options.measuring.samples = 2000;
    options.measuring.hausdorff_tolerance = 0.05;
    const LodChain chain = chain_of(test::torus(24, 12), options);
    REQUIRE(chain.levels.size() == 4);
    for (std::size_t k = 0; k < 4; ++k) {
      const LodLevel& level = chain.levels[k];
      REQUIRE(level.distance);
      REQUIRE(level.distance_bound);
      CHECK(level.distance->two_sided().hausdorff_low <= *level.distance_bound * (1 + 1e-6) + 1e-12);
      if (k > 0) CHECK(*level.distance_bound >= *chain.levels[k - 1].distance_bound);
      if (k > 0) CHECK(level.distance->two_sided().mean > 0);
    }
  }
}

TEST_CASE("Levels by errors stay within them", "[lod]") {
  const IndexedFaceSet mesh = test::icosphere(4);
  LodChainOptions options;
  options.errors = {Length::relative(1e-3), Length::relative(5e-3), Length::absolute(0.05)};
  const LodChain chain = chain_of(mesh, options);
  REQUIRE(chain.levels.size() == 4);
  CHECK(chain.last.stop == DecimateStop::kErrorBound);
  CHECK(chain.levels[1].relative_error <= 1e-3);
  CHECK(chain.levels[2].relative_error <= 5e-3);
  CHECK(chain.levels[3].error <= 0.05);
  for (std::size_t k = 1; k < 4; ++k)
    CHECK(chain.levels[k].mesh.face_count() < chain.levels[k - 1].mesh.face_count());
}

TEST_CASE("Levels keep seams, and share wedges as they share vertices", "[lod]") {
  const TwoCharts input(test::icosphere(3));
  for (const DecimateOperation operation : kLodOperations) {
    LodChainOptions options;
    options.count = 4;
    options.vertices = vertices_for(operation);
    options.decimate.operation = operation;
    options.decimate.attributes = {input.attribute()};
    const LodChain chain = chain_of(input.mesh, options);
    REQUIRE(chain.levels.size() == 4);
    if (options.vertices == LodVertices::kShared) check_prefixes(chain);
    check_topology(input.mesh, chain);
    for (const LodLevel& level : chain.levels) {
      const DecimatedAttributes& a = level.attributes;
      REQUIRE(a.corners.size() == level.mesh.half_edge_count());
      REQUIRE(a.values.at(0).size() == 2 * a.source_corner.size());
      std::size_t seams = 0;
      for (std::uint32_t c = 0; c < a.corners.size(); ++c) {
        const Vec3& p = level.positions[level.mesh.origin(HalfEdgeId(c)).index];
        const float u = a.values[0][2 * a.corners[c]];
        if (options.vertices == LodVertices::kShared)
          CHECK((u == p.x || u == p.x + 10.0f));
        else
          CHECK(std::min(std::abs(u - p.x), std::abs(u - p.x - 10)) < 0.2f);
        const HalfEdgeId twin = level.mesh.twin(HalfEdgeId(c));
        seams += std::abs(u - a.values[0][2 * a.corners[level.mesh.next(twin).index]]) > 5;
      }
      CHECK(seams >= 6);  // a closed curve, from both sides
    }
  }
}

TEST_CASE("Locked vertices and a kept boundary stay in every level", "[lod]") {
  const IndexedFaceSet mesh = test::grid(20, 20);
  LodChainOptions options;
  options.count = 3;
  options.decimate.curves.boundary = DecimateBoundary::kKept;
  options.decimate.locked.vertices = {210, 220};
  const LodChain chain = chain_of(mesh, options);
  for (const LodLevel& level : chain.levels) {
    CHECK(level.mesh.boundary_half_edge_count() == 80);
    for (const std::uint32_t v : options.decimate.locked.vertices)
      CHECK(std::find(level.source_vertex.begin(), level.source_vertex.end(), v) !=
            level.source_vertex.end());
  }
}

TEST_CASE("A chain ends where no more can go, and says why", "[lod]") {
  LodChainOptions options;
  options.count = 12;
  const LodChain chain = chain_of(test::icosphere(2), options);
  CHECK(chain.levels.back().mesh.face_count() == 4);
  CHECK(chain.levels.size() < 12);
  CHECK(chain.last.stop == DecimateStop::kNoLegalCollapse);
  for (std::size_t k = 1; k < chain.levels.size(); ++k)
    CHECK(chain.levels[k].mesh.face_count() < chain.levels[k - 1].mesh.face_count());
  // No time at all leaves the input.
  options.decimate.target.seconds = 0;
  const LodChain none = chain_of(test::icosphere(2), options);
  CHECK(none.last.stop == DecimateStop::kTimeLimit);
  REQUIRE(none.levels.size() == 1);
  CHECK(none.levels[0].mesh.face_count() == 320);
}

TEST_CASE("Options of chains that do not fit are refused", "[lod]") {
  const IndexedFaceSet mesh = test::icosphere(1);
  const auto refused = [&](auto&& change) {
    LodChainOptions options;
    options.count = 3;
    change(options);
    const auto result = lod_chain(surface_of(mesh), options);
    REQUIRE(!result);
    CHECK(result.error().code == ErrorCode::kUsage);
  };
  refused([](LodChainOptions& o) { o.count = 0; });
  refused([](LodChainOptions& o) { o.ratios = {0.5}; });
  refused([](LodChainOptions& o) { o.count = 0, o.ratios = {0.5, 0.5}; });
  refused([](LodChainOptions& o) { o.count = 0, o.ratios = {1.0}; });
  refused([](LodChainOptions& o) {
    o.count = 0, o.errors = {Length::relative(1e-2), Length::relative(1e-3)};
  });
  refused([](LodChainOptions& o) { o.count = 0, o.errors = {Length::absolute(std::nan(""))}; });
  refused([](LodChainOptions& o) { o.reduction = 1; });
  refused([](LodChainOptions& o) { o.decimate.target.faces = 10; });
  refused([](LodChainOptions& o) { o.decimate.keep_history = true; });
  refused([](LodChainOptions& o) { o.vertices = LodVertices::kShared; });
  if (!has_vertex_cache_order()) refused([](LodChainOptions& o) { o.optimize = true; });

  LodChainOptions options;
  options.count = 3;
  int calls = 0;
  const auto cancelled = lod_chain(surface_of(mesh), options, [&](double) { return ++calls < 2; });
  REQUIRE(!cancelled);
  CHECK(cancelled.error().code == ErrorCode::kInterrupted);
  // Progress rises from 0 to 1.
  double last = 0;
  options.measure = true;
  REQUIRE(lod_chain(surface_of(mesh), options, [&](double fraction) {
    CHECK(fraction >= last - 1e-12);
    CHECK(fraction <= 1);
    last = fraction;
    return true;
  }));
  CHECK(last > 0.95);
  IndexedFaceSet bad = mesh;
  bad.corners[5] = 1000000;
  CHECK(!lod_chain(surface_of(bad), options));
}

TEST_CASE("Faces in the order for vertex caches are the same faces", "[lod]") {
  if (!has_vertex_cache_order()) return;
  const TwoCharts input(test::icosphere(4));
  for (const LodVertices vertices : {LodVertices::kOwn, LodVertices::kShared}) {
    LodChainOptions options;
    options.count = 4;
    options.vertices = vertices;
    options.decimate.operation = DecimateOperation::kHalfEdgeCollapse;
    options.decimate.attributes = {input.attribute()};
    const LodChain plain = chain_of(input.mesh, options);
    options.optimize = true;
    const LodChain ordered = chain_of(input.mesh, options);
    REQUIRE(ordered.levels.size() == plain.levels.size());
    if (vertices == LodVertices::kShared) check_prefixes(ordered);
    for (std::size_t k = 0; k < plain.levels.size(); ++k) {
      const LodLevel &a = plain.levels[k], &b = ordered.levels[k];
      CHECK(triangles_by_value(a.mesh.origins(), a.positions) ==
            triangles_by_value(b.mesh.origins(), b.positions));
      // What belongs to faces and corners went with them.
      for (std::size_t f = 0; f < b.mesh.face_count(); ++f) {
        const auto at = std::lower_bound(a.source_face.begin(), a.source_face.end(), b.source_face[f]);
        REQUIRE(at != a.source_face.end());
        const std::size_t g = static_cast<std::size_t>(at - a.source_face.begin());
        for (std::size_t i = 0; i < 3; ++i)
          REQUIRE(b.attributes.source_corner[b.attributes.corners[3 * f + i]] ==
                  a.attributes.source_corner[a.attributes.corners[3 * g + i]]);
      }
      // A cache of 16 vertices that is filled in turn misses less.
      const auto misses = [](std::span<const std::uint32_t> corners) {
        std::vector<std::uint32_t> cache(16, kInvalid);
        std::size_t missed = 0;
        for (const std::uint32_t v : corners)
          if (std::find(cache.begin(), cache.end(), v) == cache.end()) cache[missed++ % 16] = v;
        return missed;
      };
      if (k == 0) CHECK(misses(b.attributes.corners) * 10 < misses(a.attributes.corners) * 9);
    }
  }
}

TEST_CASE("Levels of a scan in partitions are manifold, and share vertices", "[lod]") {
  auto read = to_indexed_face_set(read_mesh(test::dragon("dragon_vrip_res2.ply.gz")).value()).value();
  const IndexedFaceSet mesh = consolidate(std::move(read), {}).value().face_set;
  for (const DecimateOperation operation :
       {DecimateOperation::kEdgeCollapse, DecimateOperation::kHalfEdgeCollapse}) {
    LodChainOptions options;
    options.count = 6;
    options.decimate.operation = operation;
    options.vertices = vertices_for(operation);
    const LodChain chain = chain_of(mesh, options);
    REQUIRE(chain.levels.size() == 6);
    CHECK(chain.levels[5].mesh.face_count() <= mesh.face_count() / 32 + 1);
    for (const LodLevel& level : chain.levels)
      CHECK(level.mesh.boundary_loops().size() == chain.levels[0].mesh.boundary_loops().size());
    if (options.vertices == LodVertices::kShared) check_prefixes(chain);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const LodChain alone = chain_of(mesh, options);
    for (std::size_t k = 0; k < 6; ++k) {
      CHECK(std::ranges::equal(alone.levels[k].mesh.origins(), chain.levels[k].mesh.origins()));
      CHECK(alone.levels[k].positions == chain.levels[k].positions);
    }
  }
}

}  // namespace vkmesh
