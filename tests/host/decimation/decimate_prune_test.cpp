// Components that are pruned, and parts that are locked.
#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/analysis/topology.h>
#include <vkmesh/decimation/decimate.h>

#include "decimation/decimate_support.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

using test::run;

DecimateOperation any_operation() {
  return GENERATE(DecimateOperation::kEdgeCollapse, DecimateOperation::kHalfEdgeCollapse,
                  DecimateOperation::kVertexRemoval);
}

/// The faces of a result as points, each with its least corner first.
std::set<std::array<std::array<float, 3>, 3>> faces_of(std::span<const Vec3> points,
                                                       std::span<const std::uint32_t> corners) {
  std::set<std::array<std::array<float, 3>, 3>> faces;
  for (std::size_t c = 0; c < corners.size(); c += 3) {
    std::array<std::array<float, 3>, 3> face;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& p = points[corners[c + i]];
      face[i] = {p.x, p.y, p.z};
    }
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    faces.insert(face);
  }
  return faces;
}

}  // namespace

TEST_CASE("decimation: small components are pruned, and the largest stays", "[decimate]") {
  const DecimateOperation operation = any_operation();
  // A sphere of radius 1 and three thousand of 0.01, some with a boundary, all about it.
  IndexedFaceSet mesh = test::icosphere(3);
  const std::size_t large_points = mesh.points.size(), large_faces = mesh.face_count();
  IndexedFaceSet sheet = test::grid(2, 1);
  for (Vec3& p : sheet.points) p *= 0.01f;
  const IndexedFaceSet ball = test::icosphere(0, 0.01f);
  std::size_t small_faces = 0;
  for (int i = 0; i < 3000; ++i) {
    const IndexedFaceSet& small = i % 2 == 0 ? ball : sheet;
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    const Vec3 place(2.0f + 0.1f * static_cast<float>(i % 50), 0.1f * static_cast<float>(i / 50), 0.0f);
    for (const Vec3& p : small.points) mesh.points.push_back(p + place);
    for (const std::uint32_t c : small.corners) mesh.corners.push_back(first + c);
    small_faces += small.face_count();
  }
  DecimateOptions options;
  options.operation = operation;
  options.target.faces = 300;
  const Decimated kept = run(mesh, options);
  CHECK(kept.stop == DecimateStop::kNoLegalCollapse);  // a ball has four faces at least, a sheet one
  CHECK(kept.mesh.face_count() >= 1500 * 4 + 1500);

  options.prune_size = Length::absolute(0.05);  // a ball's box has 0.029, a sheet's 0.022
  const Decimated pruned = run(mesh, options);
  CHECK(pruned.pruned_components == 3000);
  CHECK(pruned.pruned_faces == small_faces);
  CHECK(pruned.stop == DecimateStop::kTargetReached);
  CHECK(pruned.mesh.face_count() == 300);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    CHECK((pruned.vertex_map[v] != kInvalid) == (v < large_points));
  // As if they had not been there: the frame is another, but no vertex of one is at stake in the other.
  CHECK(std::all_of(pruned.source_face.begin(), pruned.source_face.end(),
                    [&](std::uint32_t f) { return f < large_faces; }));

  options.prune_size = Length::absolute(0.025);
  const Decimated sheets = run(mesh, options);
  CHECK(sheets.pruned_components == 1500);
  // A share of the diagonal; and the largest stays even when it is small enough.
  options.prune_size.reset();
  options.prune_size = Length::relative(1.0);
  const Decimated largest = run(mesh, options);
  CHECK(largest.pruned_components == 3000);
  CHECK(largest.mesh.face_count() == 300);

  options.prune_size = Length::relative(-1.0);
  CHECK(decimate(test::half_edges(mesh), mesh.points, options).error().code == ErrorCode::kUsage);
}

TEST_CASE("decimation: locked edges and faces stay as they are", "[decimate]") {
  const DecimateOperation operation = any_operation();
  IndexedFaceSet mesh = test::torus(24, 16);
  test::jitter(mesh, 0.02f, 3);
  const HalfEdgeMesh half_edges = test::half_edges(mesh);
  DecimateOptions options;
  options.operation = operation;
  options.target.faces = 0;
  const std::vector<std::uint32_t> faces = {3, 4, 5, 100, 101, 333};
  options.locked.faces = faces;
  const Decimated with_faces = run(mesh, options);
  CHECK(with_faces.mesh.face_count() < mesh.face_count() / 4);
  const auto left = faces_of(with_faces.positions, with_faces.mesh.origins());
  for (const std::uint32_t f : faces) {
    const auto locked = faces_of(mesh.points, mesh.face(f));
    CHECK(left.contains(*locked.begin()));
  }

  options.locked.faces.clear();
  options.locked.edges = {0, 17, 302, 303};
  const Decimated with_edges = run(mesh, options);
  CHECK(with_edges.mesh.face_count() < mesh.face_count() / 4);
  for (const std::uint32_t h : options.locked.edges) {
    const std::uint32_t from = half_edges.origin(HalfEdgeId(h)).index,
                        to = half_edges.target(HalfEdgeId(h)).index;
    const std::uint32_t p = with_edges.vertex_map[from], q = with_edges.vertex_map[to];
    CHECK(with_edges.positions[p] == mesh.points[from]);
    CHECK(with_edges.positions[q] == mesh.points[to]);
    bool found = false;
    for (std::uint32_t g = 0; g < with_edges.mesh.half_edge_count(); ++g)
      found = found || (with_edges.mesh.origin(HalfEdgeId(g)).index == p &&
                        with_edges.mesh.target(HalfEdgeId(g)).index == q);
    CHECK(found);
  }

  options.locked.edges = {static_cast<std::uint32_t>(mesh.corners.size())};
  CHECK(decimate(half_edges, mesh.points, options).error().code == ErrorCode::kUsage);
  options.locked.edges.clear();
  options.locked.faces = {static_cast<std::uint32_t>(mesh.face_count())};
  CHECK(decimate(half_edges, mesh.points, options).error().code == ErrorCode::kUsage);
}

}  // namespace vkmesh
