// Every pass on meshes with triangles without area, edges without length, and points in no face: what comes
// out is finite.
#include <algorithm>
#include <cmath>
#include <string>

#include <catch2/catch.hpp>

#include <vkmesh/mesh/node_neighbours.h>
#include <vkmesh/passes/bilateral_smoothing.h>
#include <vkmesh/passes/curvatures.h>
#include <vkmesh/passes/dihedral_angles.h>
#include <vkmesh/passes/laplacian_smoothing.h>
#include <vkmesh/passes/restore_volume.h>
#include <vkmesh/passes/surface_measures.h>
#include <vkmesh/passes/triangle_normals.h>
#include <vkmesh/passes/vertex_normals.h>

#include "support/shapes.h"
#include "support/vectors.h"

using namespace vkmesh;

namespace {

bool finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float x) { return std::isfinite(x); });
}
bool finite(const std::vector<Vec3>& values) {
  return std::all_of(values.begin(), values.end(), [](const Vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  });
}

}  // namespace

TEST_CASE("no pass makes NaN of degenerate triangles, edges without length or isolated points") {
  for (const auto& [name, set] : test::degenerate_shapes()) {
    INFO(name);
    const HalfEdgeMesh mesh = test::half_edges(set);
    const NodeNeighbours neighbours = node_neighbours(mesh).value();
    CHECK(finite(triangle_normals(mesh, set.points).value()));
    for (const NormalWeights weights : {NormalWeights::kArea, NormalWeights::kAngle, NormalWeights::kUniform})
      CHECK(finite(vertex_normals(mesh, set.points, {.weights = weights}).value()));
    const DihedralAngles angles = dihedral_angles(mesh, set.points).value();
    CHECK((finite(angles.half_edge) && finite(angles.vertex_maximum)));
    const auto curved = curvatures(neighbours, set.points).value();
    for (const VertexCurvature& c : curved)
      CHECK(finite(std::vector<float>{c.mean, c.gaussian, c.area, c.angle_defect}));
    const SurfaceMeasures measures = surface_measures(mesh, set.points).value();
    CHECK((std::isfinite(measures.area) && std::isfinite(measures.volume)));
    CHECK(std::isfinite(test::length(measures.centroid)));
    for (const SmoothingWeights weights : {SmoothingWeights::kUniform, SmoothingWeights::kCotangent})
      for (const float mu : {0.0f, -0.53f}) {
        const auto smoothed =
            laplacian_smoothing(
                neighbours, set.points,
                {.iterations = 20, .boundary = SmoothingBoundary::kFree, .weights = weights, .mu = mu})
                .value();
        CHECK(finite(smoothed));
        // In no face; what is below 2^-100 becomes 0.
        CHECK(test::length(DVec3(smoothed.back()) - DVec3(set.points.back())) < 1e-30);
        if (mesh.boundary_half_edge_count() == 0)
          CHECK(finite(restore_volume(mesh, set.points, smoothed).value()));
      }
    // Widths have to lie in [2^-40, 2^40].
    const auto width = static_cast<float>(mean_edge_length(mesh, set.points));
    const auto smoothed =
        bilateral_smoothing(mesh, set.points, {std::max(2 * width, 1.0f), std::max(width, 1.0f)});
    if (width < 0x1p39f)
      CHECK(finite(smoothed.value()));
    else
      CHECK(smoothed.error().code == ErrorCode::kUsage);
  }
}

TEST_CASE("all passes but vertex normals take triangles only, and one position for each vertex") {
  const IndexedFaceSet quads = test::quad_cube();
  const HalfEdgeMesh mesh = test::half_edges(quads);
  CHECK(dihedral_angles(mesh, quads.points).error().code == ErrorCode::kUnsuitable);
  CHECK(triangle_normals(mesh, quads.points).error().code == ErrorCode::kUnsuitable);
  CHECK(surface_measures(mesh, quads.points).error().code == ErrorCode::kUnsuitable);
  const IndexedFaceSet cube = test::cube();
  CHECK(vertex_normals(test::half_edges(cube), std::span(cube.points).first(5)).error().code ==
        ErrorCode::kUsage);
}
