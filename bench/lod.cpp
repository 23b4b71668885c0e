// vkmesh_bench_lod [MESH] [REPETITIONS]: chains of levels of detail, as tables in Markdown: how long one
// takes beside one decimation to its last level, and how far each level lies from the surface beside a
// decimation straight to it.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <tbb/global_control.h>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/lod/lod_chain.h>
#include <vkmesh/mesh/triangle_surface.h>
#include <vkmesh/repair/consolidate.h>

#include "bench/machine.h"

namespace vkmesh::bench {
namespace {

constexpr std::size_t kLevels = 8;

template <class T>
T need(Result<T> result, const char* what) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "vkmesh_bench_lod: %s: %s\n", what, result.error().describe().c_str());
  std::exit(1);
}

/// Seconds of each run, ascending.
template <class F>
std::vector<double> time_runs(int repetitions, F&& f) {
  std::vector<double> seconds;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    f();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::ranges::sort(seconds);
  return seconds;
}

struct Case {
  const char* name;
  DecimateOperation operation;
  LodVertices vertices;
};
constexpr Case kCases[] = {
    {"edge collapse, own vertices", DecimateOperation::kEdgeCollapse, LodVertices::kOwn},
    {"half-edge collapse, shared vertices", DecimateOperation::kHalfEdgeCollapse, LodVertices::kShared},
    {"vertex removal, shared vertices", DecimateOperation::kVertexRemoval, LodVertices::kShared}};

double mean_error(const TriangleSurface& surface, const Decimated& level) {
  SurfaceDistanceOptions sampling;
  sampling.samples = 50000;
  const SurfaceDistance apart =
      need(surface_distance(surface, {level.positions, level.mesh.origins()}, sampling), "distance");
  return apart.two_sided().mean / apart.diagonal;
}

void times(const TriangleSurface& surface, const Case& which, std::size_t threads, int repetitions) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  LodChainOptions options;
  options.count = kLevels;
  options.decimate.operation = which.operation;
  options.vertices = which.vertices;
  LodChain chain = need(lod_chain(surface, options), "chain");
  DecimateOptions straight = options.decimate;
  straight.target.faces = chain.levels.back().mesh.face_count();
  // Taken in turn, so that what else the machine does meets both.
  std::vector<double> one, all;
  for (int i = 0; i < repetitions; ++i) {
    one.push_back(time_runs(1, [&] { static_cast<void>(need(decimate(surface, straight), "decimate")); })[0]);
    all.push_back(time_runs(1, [&] { chain = need(lod_chain(surface, options), "chain"); })[0]);
  }
  std::ranges::sort(one);
  std::ranges::sort(all);
  const double a = one[one.size() / 2], b = all[all.size() / 2];
  std::printf("| %s | %zu | %zu | %.3f (%.3f-%.3f) | %.3f (%.3f-%.3f) | %.2f |\n", which.name, threads,
              chain.levels.back().mesh.face_count(), a, one.front(), one.back(), b, all.front(), all.back(),
              b / a);
  std::fflush(stdout);
}

void errors(const TriangleSurface& surface, const Case& which) {
  LodChainOptions options;
  options.count = kLevels;
  options.decimate.operation = which.operation;
  options.vertices = which.vertices;
  const LodChain chain = need(lod_chain(surface, options), "chain");
  for (std::size_t k = 1; k < chain.levels.size(); ++k) {
    DecimateOptions straight = options.decimate;
    straight.target.faces = chain.levels[k].mesh.face_count();
    const Decimated alone = need(decimate(surface, straight), "decimate");
    const double of_level = mean_error(surface, chain.levels[k]), of_alone = mean_error(surface, alone);
    std::printf("| %s | %zu | %zu | %.3e | %.3e | %.3f | %.2e |\n", k == 1 ? which.name : "", k,
                chain.levels[k].mesh.face_count(), of_level, of_alone, of_level / of_alone,
                chain.levels[k].relative_error);
    std::fflush(stdout);
  }
}

void all(const std::string& file, int repetitions) {
  MeshFile read = need(read_mesh(file), file.c_str());
  ConsolidateOptions welding;
  welding.weld_boundary = true;
  const Consolidated scan =
      need(consolidate(need(to_indexed_face_set(std::move(read)), file.c_str()), welding), file.c_str());
  const TriangleSurface surface{scan.face_set.points, scan.mesh.origins()};
  const Machine machine = describe_machine();
  std::printf("- %s, %s\n- %s\n- %s, %zu faces; %zu levels with half of the faces each\n\n",
              machine.processor.c_str(), machine.system.c_str(), machine.compiler.c_str(),
              file.substr(file.rfind('/') + 1).c_str(), surface.corners.size() / 3, kLevels);
  std::printf(
      "| levels by | threads | faces of the last | decimated to it alone, s: median (min-max of %d) | "
      "all levels, s | times as long |\n|---|---:|---:|---|---|---:|\n",
      repetitions);
  for (const Case& which : kCases)
    for (const std::size_t threads : {std::size_t{1}, std::size_t{2}})
      times(surface, which, threads, repetitions);
  std::printf(
      "\n| levels by | level | faces | mean distance / diagonal | of a decimation straight to it | ratio | "
      "error told / diagonal |\n|---|---:|---:|---:|---:|---:|---:|\n");
  for (const Case& which : kCases) errors(surface, which);
}

}  // namespace
}  // namespace vkmesh::bench

int main(int argc, char** argv) {
  vkmesh::bench::all(argc > 1 ? argv[1] : VKMESH_DEFAULT_MESH, argc > 2 ? std::atoi(argv[2]) : 5);
}
