// vkmesh_bench_remeshing [MESH] [REPETITIONS]: times and figures of remeshing, as a table in Markdown.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <tbb/global_control.h>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/analysis/triangle_angles.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/mesh/triangle_surface.h>
#include <vkmesh/remesh/remesh.h>
#include <vkmesh/repair/consolidate.h>

#include "bench/machine.h"

namespace vkmesh::bench {
namespace {

template <class T>
T need(Result<T> result, const char* what) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "vkmesh_bench_remeshing: %s: %s\n", what, result.error().describe().c_str());
  std::exit(1);
}

/// The median of some runs, and what came of it, as a row.
void row(const HalfEdgeMesh& mesh, const std::vector<Vec3>& points, const std::string& what,
         const RemeshOptions& options, int repetitions) {
  std::vector<double> seconds;
  Remeshed made;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    made = need(remesh(mesh, points, options), what.c_str());
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::ranges::sort(seconds);
  const TriangleAngles angles = need(triangle_angles(made.mesh, made.positions), "angles");
  const TriangleSurface before{points, mesh.origins()}, after{made.positions, made.mesh.origins()};
  SurfaceDistanceOptions precise;
  precise.hausdorff_tolerance = 0.05;
  const SurfaceDistance apart = need(surface_distance(before, after, precise), "distance");
  const double faces = static_cast<double>(made.mesh.face_count());
  std::printf("| %s | %zu | %.2f | %.2f-%.2f (%d) | %.1f | %.2f | %zu | %.3f | %.3f |\n", what.c_str(),
              made.mesh.face_count(), seconds[seconds.size() / 2], seconds.front(), seconds.back(),
              repetitions, angles.mean * 180 / std::numbers::pi,
              100 * static_cast<double>(angles.below_30_degrees) / faces, angles.below_5_degrees,
              apart.a_to_b.hausdorff_high / made.edge_length, apart.b_to_a.hausdorff_high / made.edge_length);
  std::fflush(stdout);
}

void all(const std::string& file, int repetitions) {
  MeshFile read = need(read_mesh(file), file.c_str());
  // As the program does: the strips of the scan are one surface.
  ConsolidateOptions welding;
  welding.weld_boundary = true;
  const Consolidated scan =
      need(consolidate(need(to_indexed_face_set(std::move(read)), file.c_str()), welding), file.c_str());
  DecimateOptions decimation;
  decimation.target.faces = 100000;
  const Decimated tenth = need(decimate(scan.mesh, scan.face_set.points, decimation), "decimate");
  const Machine machine = describe_machine();
  std::printf("- %s, %s\n- %s\n- one thread; %s at %zu faces, ten iterations\n\n", machine.processor.c_str(),
              machine.system.c_str(), machine.compiler.c_str(), file.substr(file.rfind('/') + 1).c_str(),
              tenth.mesh.face_count());
  std::printf(
      "| what | faces | median s | min-max (runs) | mean least angle | below 30 degrees, %% | below 5 | "
      "old to new, edges | new to old, edges |\n|---|---:|---:|---|---:|---:|---:|---:|---:|\n");
  RemeshOptions options;
  row(tenth.mesh, tenth.positions, "own mean length", options, repetitions);
  const double length = need(remesh(tenth.mesh, tenth.positions, options), "length").edge_length;
  options.max_deviation = Length::absolute(0.1 * length);
  row(tenth.mesh, tenth.positions, "the same, within a tenth of it", options, repetitions);
  options = {};
  options.size.deviation = Length::absolute(0.1 * length);
  row(tenth.mesh, tenth.positions, "by curvature, a tenth of it", options, repetitions);
}

}  // namespace
}  // namespace vkmesh::bench

int main(int argc, char** argv) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  vkmesh::bench::all(argc > 1 ? argv[1] : VKMESH_DEFAULT_MESH, argc > 2 ? std::atoi(argv[2]) : 5);
}
