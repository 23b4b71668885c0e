// vkmesh_bench_optimisation [MESH] [REPETITIONS]: times of edge swaps, as a table in Markdown.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <tbb/global_control.h>

#include <vkmesh/analysis/triangle_angles.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/optimize/intrinsic_triangulation.h>
#include <vkmesh/optimize/swap_edges.h>
#include <vkmesh/passes/swap_rounds.h>
#include <vkmesh/repair/consolidate.h>
#ifdef VKMESH_BENCH_DEVICE
#include <vkmesh/engine/core/context.h>
#include <vkmesh/engine/passes/swap_rounds.h>
#endif

#include "bench/machine.h"

namespace vkmesh::bench {
namespace {

struct Subject {
  std::string name;
  IndexedFaceSet set;
  HalfEdgeMesh mesh;
};

template <class T>
T need(Result<T> result, const char* what) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "vkmesh_bench_optimisation: %s: %s\n", what, result.error().describe().c_str());
  std::exit(1);
}

/// Points in a unit cell each, moved by up to `jitter` of it, cut along the same diagonals: 2 n² triangles of
/// a plane.
Subject plane(std::uint32_t n, double jitter) {
  Subject plane;
  std::mt19937 random(1);
  const auto moved = [&](std::uint32_t i) {
    return static_cast<float>(i + 2 * jitter * (static_cast<double>(random()) / 4294967296.0 - 0.5));
  };
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x) {
      const float at = moved(x);
      plane.set.points.emplace_back(at, moved(y), 0.0f);
    }
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x, b = a + 1, d = a + n + 1, c = d + 1;
      for (const std::uint32_t v : {a, b, c, a, c, d}) plane.set.corners.push_back(v);
    }
  plane.name = "plane, " + std::to_string(plane.set.points.size()) + " points moved by " +
               std::to_string(jitter).substr(0, 3);
  plane.mesh = need(to_half_edge_mesh(plane.set), "plane");
  return plane;
}

/// The torus of docs/torus.awk in its size of tests: points that lie on it, random diagonals.
Subject torus(std::uint32_t rings, std::uint32_t sides) {
  Subject torus;
  std::mt19937 random(11);
  constexpr double kTurn = 6.283185307179586;
  const auto step = [&] { return 0.66 * (static_cast<double>(random()) / 4294967296.0 - 0.5); };
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < sides; ++j) {
      const double u = kTurn * (i + step()) / rings, v = kTurn * (j + step()) / sides;
      torus.set.points.emplace_back((1 + 0.4 * std::cos(v)) * std::cos(u),
                                    (1 + 0.4 * std::cos(v)) * std::sin(u), 0.4 * std::sin(v));
    }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i % rings * sides + j % sides; };
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < sides; ++j) {
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      const bool first = random() % 2 == 0;
      for (const std::uint32_t v : first ? std::array{a, b, c, a, c, d} : std::array{a, b, d, b, c, d})
        torus.set.corners.push_back(v);
    }
  torus.name = "torus, " + std::to_string(torus.set.points.size()) + " points, random diagonals";
  torus.mesh = need(to_half_edge_mesh(torus.set), "torus");
  return torus;
}

/// The median of some runs of work that returns how many swaps it did, as a row.
void row(const Subject& subject, const std::string& what, int repetitions,
         const std::function<std::pair<std::size_t, std::string>()>& work) {
  std::vector<double> milliseconds;
  std::pair<std::size_t, std::string> done;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    done = work();
    milliseconds.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::ranges::sort(milliseconds);
  const double median = milliseconds[milliseconds.size() / 2];
  std::printf("| %s | %s | %zu | %.1f | %.1f-%.1f (%d) | %.0f | %s |\n", subject.name.c_str(), what.c_str(),
              done.first, median, milliseconds.front(), milliseconds.back(), repetitions,
              median > 0 ? static_cast<double>(done.first) / median : 0.0, done.second.c_str());
  std::fflush(stdout);
}

void greedy(const Subject& subject, const char* name, SwapCost cost, int repetitions) {
  row(subject, std::string("greedy, ") + name, repetitions, [&] {
    SwapEdgesOptions options;
    options.costs = {{cost, 1}};
    const SwappedEdges swapped = need(swap_edges(subject.mesh, subject.set.points, options), name);
    return std::pair(swapped.swaps, std::string("ends: ") + name_of(swapped.stop));
  });
}

std::pair<std::size_t, std::string> told(const SwapRounds& rounds) {
  std::size_t swaps = 0;
  for (const std::uint32_t n : rounds.swaps) swaps += n;
  return {swaps, std::to_string(rounds.swaps.size() - 1) + " rounds"};
}

void all(const std::string& file, int repetitions) {
  Subject scan;
  scan.name = file.substr(file.rfind('/') + 1);
  MeshFile read = need(read_mesh(file), file.c_str());
  Consolidated made =
      need(consolidate(need(to_indexed_face_set(std::move(read)), file.c_str())), file.c_str());
  scan.set = std::move(made.face_set);
  scan.mesh = std::move(made.mesh);
  scan.name += ", " + std::to_string(scan.mesh.face_count()) + " triangles";
  const Machine machine = describe_machine();
  std::printf("- %s, %s\n- %s\n- one thread; half-edges in, half-edges out\n\n", machine.processor.c_str(),
              machine.system.c_str(), machine.compiler.c_str());
  std::printf(
      "| mesh | what | swaps | median ms | min-max (runs) | swaps a ms | "
      "|\n|---|---|---:|---:|---|---:|---|\n");
  for (const auto& [name, cost] : {std::pair{"max-min angle", SwapCost::kMinAngle},
                                   {"aspect ratio", SwapCost::kAspectRatio},
                                   {"Delaunay", SwapCost::kDelaunay},
                                   {"valence", SwapCost::kValence},
                                   {"mean curvature", SwapCost::kMeanCurvature}})
    greedy(scan, name, cost, repetitions);
  row(scan, "intrinsic Delaunay", repetitions, [&] {
    IntrinsicTriangulation t = need(IntrinsicTriangulation::create(scan.mesh, scan.set.points), "intrinsic");
    const auto flips = need(t.flip_to_delaunay(), "intrinsic");
    return std::pair(flips.flips, std::string(flips.finished ? "ends" : "does not end"));
  });
  const Subject round = torus(100, 160);
  for (const auto& [name, cost] : {std::pair{"max-min angle", SwapCost::kMinAngle},
                                   {"mean curvature", SwapCost::kMeanCurvature},
                                   {"squared curvature", SwapCost::kSquaredMeanCurvature},
                                   {"absolute curvature", SwapCost::kAbsoluteCurvature}})
    greedy(round, name, cost, repetitions);
  const Subject flat = plane(1000, 0.3);
  greedy(flat, "max-min angle", SwapCost::kMinAngle, repetitions);
  SwapRounds on_cpu;
  row(flat, "rounds, CPU", 1, [&] {
    on_cpu = need(swap_rounds(flat.mesh, flat.set.points), "rounds");
    return told(on_cpu);
  });
#ifdef VKMESH_BENCH_DEVICE
  ContextOptions options;
  options.device = "llvmpipe";
  auto context = Context::create(options);
  if (!context) return;
  row(flat, "rounds, llvmpipe", 1, [&] {
    DeviceMesh mesh = need(DeviceMesh::create(**context, flat.mesh, flat.set.points), "device");
    const SwapRounds rounds = need(run_swap_rounds(**context, mesh), "rounds");
    auto done = told(rounds);
    done.second += std::ranges::equal(rounds.mesh.origins(), on_cpu.mesh.origins()) ? ", the CPU's bytes"
                                                                                    : ", OTHER BYTES";
    return done;
  });
#endif
}

}  // namespace
}  // namespace vkmesh::bench

int main(int argc, char** argv) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  vkmesh::bench::all(argc > 1 ? argv[1] : VKMESH_DEFAULT_MESH, argc > 2 ? std::atoi(argv[2]) : 5);
}
