// vkmesh_bench: vkmesh beside its peers, on one mesh and in one run.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/analysis/topology.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/mesh/triangulate.h>

#include "bench/contestants.h"
#include "bench/machine.h"
#include "bench/memory.h"
#include "bench/report.h"

namespace vkmesh::bench {
namespace {

struct Options {
  std::string mesh = VKMESH_DEFAULT_MESH;
  std::string device = "llvmpipe";
  std::size_t repetitions = 7;
  std::size_t slow_repetitions = 1;
  std::size_t samples = 200000;
  std::vector<double> ratios = {0.1, 0.01};
  std::string only;
  std::string json;
  std::string markdown;
};

Result<Input> read_input(const Options& options) {
  Input input;
  VKMESH_TRY(MeshFile file, read_mesh(options.mesh));
  VKMESH_TRY(input.mesh, to_indexed_face_set(std::move(file)));
  if (!input.mesh.is_triangles()) {
    VKMESH_TRY(Triangulated triangulated, triangulate(input.mesh));
    input.mesh = std::move(triangulated.mesh);
  }
  if (input.mesh.face_count() == 0)
    return fail(ErrorCode::kUnsuitable, options.mesh + ": no faces to measure with");
  constexpr std::uint32_t kSeed = 6;
  input.shuffled = shuffled(input.mesh, kSeed);
  input.ratios = options.ratios;
  return input;
}

Result<Programme> programme_for(const Options& options, const Input& input, const ReadingFiles& files) {
  Programme programme;
  programme.libraries.push_back({"vkmesh", VKMESH_VERSION});
  add_reading(programme, files);
  add_soup(programme, input);
  VKMESH_CHECK(add_host(programme, input));
  add_host_built_ins(programme, input);
#ifdef VKMESH_BENCH_DEVICE
  if (options.device != "none") {
    VKMESH_CHECK(add_device(programme, input, options.device));
    VKMESH_CHECK(add_built_ins(programme, input, options.device));
  }
#endif
#ifdef VKMESH_BENCH_OPENMESH
  add_openmesh(programme, input, files);
#endif
#ifdef VKMESH_BENCH_MESHOPTIMIZER
  add_meshoptimizer(programme, input);
#endif
  std::erase_if(programme.contestants, [&](const Contestant& contestant) {
    return contestant.step.find(options.only) == std::string::npos ||
           (contestant.slow && options.slow_repetitions == 0);
  });
  // Contestants of one step stand together, the steps in the order of their first.
  std::vector<std::string> steps;
  for (const Contestant& contestant : programme.contestants)
    if (std::find(steps.begin(), steps.end(), contestant.step) == steps.end())
      steps.push_back(contestant.step);
  std::stable_sort(programme.contestants.begin(), programme.contestants.end(),
                   [&](const Contestant& a, const Contestant& b) {
                     return std::find(steps.begin(), steps.end(), a.step) <
                            std::find(steps.begin(), steps.end(), b.step);
                   });
  return programme;
}

Result<DecimationQuality> quality_of(const Surface& surface, const IndexedFaceSet& original,
                                     std::size_t samples) {
  SurfaceDistanceOptions sampling;
  sampling.samples = samples;
  VKMESH_TRY(const SurfaceDistance distance, surface_distance({original.points, original.corners},
                                                              {surface.points, surface.corners}, sampling));
  const DistanceSummary both = distance.two_sided();
  IndexedFaceSet faces;
  faces.points = surface.points;
  faces.corners = surface.corners;
  VKMESH_TRY(const SurfaceTopology topology, surface_topology(faces));
  DecimationQuality quality;
  quality.faces = surface.corners.size() / 3;
  quality.mean = both.mean / distance.diagonal;
  quality.maximum = both.maximum / distance.diagonal;
  quality.non_manifold_edges = topology.whole.non_manifold_edges + topology.whole.misoriented_edges;
  quality.non_manifold_vertices = topology.whole.non_manifold_vertices;
  return quality;
}

Result<Report> measure(const Options& options, const Input& input, const Programme& programme) {
  Report report;
  report.mesh = options.mesh.substr(options.mesh.find_last_of('/') + 1);
  report.vertices = input.mesh.points.size();
  report.faces = input.mesh.face_count();
  report.samples = options.samples;
  report.machine = describe_machine();
  report.libraries = programme.libraries;
  for (const Contestant& contestant : programme.contestants)
    report.rows.push_back({contestant.step, contestant.name, {}, {}, {}, contestant.bytes});

  // Step by step; within a step A B A B, so that what disturbs the machine disturbs all alike.
  for (std::size_t begin = 0, end = 0; begin < programme.contestants.size(); begin = end) {
    const std::string& step = programme.contestants[begin].step;
    while (end < programme.contestants.size() && programme.contestants[end].step == step) ++end;
    for (std::size_t round = 0; round < options.repetitions; ++round)
      for (std::size_t i = begin; i < end; ++i) {
        const Contestant& contestant = programme.contestants[i];
        if (contestant.slow && round >= options.slow_repetitions) continue;
        std::fprintf(stderr, "\r\033[K%s, %s: %zu", step.c_str(), contestant.name.c_str(), round + 1);
        const MemoryWatch memory;
        VKMESH_TRY(const double milliseconds, contestant.run());
        // Taken from the first run: later ones begin with the result of the one before.
        if (contestant.surface && round == 0) report.rows[i].memory = memory.peak();
        report.rows[i].milliseconds.push_back(milliseconds);
      }
  }
  for (std::size_t i = 0; i < programme.contestants.size(); ++i) {
    const Contestant& contestant = programme.contestants[i];
    if (!contestant.surface) continue;
    std::fprintf(stderr, "\r\033[Kerror of %s", contestant.name.c_str());
    const Surface surface = contestant.surface();
    VKMESH_TRY(report.rows[i].quality, quality_of(surface, input.mesh, options.samples));
  }
  std::fprintf(stderr, "\r\033[K");
  return report;
}

Result<void> write(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) return fail(ErrorCode::kNotWritable, "cannot be written", {path, {}, {}});
  return {};
}

Result<void> run(const Options& options) {
  keep_freed_memory();
  VKMESH_TRY(const Input input, read_input(options));
  VKMESH_TRY(const ReadingFiles files, ReadingFiles::write(input.mesh));
  VKMESH_TRY(const Programme programme, programme_for(options, input, files));
  VKMESH_TRY(const Report report, measure(options, input, programme));
  std::fputs(to_text(report).c_str(), stdout);
  if (!options.json.empty()) VKMESH_CHECK(write(options.json, to_json(report).dump(2) + "\n"));
  if (!options.markdown.empty()) VKMESH_CHECK(write(options.markdown, to_markdown(report)));
  return {};
}

}  // namespace
}  // namespace vkmesh::bench

int main(int argc, char** argv) {
  vkmesh::bench::Options options;
  CLI::App app("Times vkmesh beside OpenMesh and meshoptimizer, interleaved, and prints medians and ratios.");
  app.add_option("mesh", options.mesh, "Mesh to measure with")->capture_default_str();
  app.add_option("--device", options.device, "Vulkan device by index or name; none leaves its rows out")
      ->capture_default_str();
  app.add_option("--repetitions", options.repetitions, "Runs of each row")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--slow-repetitions", options.slow_repetitions,
                 "Runs of a row that takes tens of seconds; 0 leaves such rows out")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
  app.add_option("--samples", options.samples, "Samples each way for errors")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000000));
  app.add_option("--ratio", options.ratios, "Shares of the faces that decimation leaves")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--only", options.only, "Steps whose name holds this");
  app.add_option("--json", options.json, "Also write the measurements here");
  app.add_option("--markdown", options.markdown, "Also write the table here");
  CLI11_PARSE(app, argc, argv);
  const auto done = vkmesh::bench::run(options);
  if (!done) {
    std::fprintf(stderr, "vkmesh_bench: %s\n", done.error().describe().c_str());
    return static_cast<int>(done.error().code);
  }
  return 0;
}
