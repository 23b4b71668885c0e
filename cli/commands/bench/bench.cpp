// vkmesh bench: times every pass, beside a plain copy of the bytes that it must touch.
#include "commands/bench/bench.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/mesh/triangulate.h>
#include <vkmesh/passes/bilateral_smoothing.h>
#include <vkmesh/passes/collapse_costs.h>
#include <vkmesh/passes/curvatures.h>
#include <vkmesh/passes/dihedral_angles.h>
#include <vkmesh/passes/laplacian_smoothing.h>
#include <vkmesh/passes/surface_measures.h>
#include <vkmesh/passes/swap_scores.h>
#include <vkmesh/passes/triangle_normals.h>
#include <vkmesh/passes/vertex_normals.h>

#include "commands.h"
#include "passes/backend.h"

namespace vkmesh::cli {

BenchBytes::BenchBytes(const BenchSubject& subject) {
  const std::uint64_t v = subject.mesh.vertex_count(), f = subject.mesh.face_count(),
                      directed = subject.neighbours.ids.size();
  const std::uint64_t points = 12 * v, per_half_edge = 12 * f, lists = 4 * v + 4 * directed;
  triangle_normals = points + per_half_edge + 12 * f;
  vertex_normals = points + per_half_edge + points;
  dihedral_angles = points + 2 * per_half_edge + per_half_edge + 4 * v;
  curvatures = points + lists + 16 * v;
  smoothing_step = points + lists + points;
  measures = points + per_half_edge;
  bilateral_smoothing = points + per_half_edge + points;
  collapse_costs = points + 2 * per_half_edge + 24 * v + per_half_edge;
  swap_scores = points + 2 * per_half_edge + per_half_edge;
  decimation = points + per_half_edge + (points + per_half_edge) / 10;
}

BilateralWidth bench_widths(const BenchSubject& subject) {
  const double edge = mean_edge_length(subject.mesh, subject.positions);
  return {static_cast<float>(4 * edge), static_cast<float>(edge)};
}

namespace {

struct BenchOptions {
  std::vector<std::string> files;
  std::size_t splits = 0, repetitions = 5;
  std::string only;
};

template <class Work>
Result<double> timed(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  const auto result = work();
  const double milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (!result) return tl::unexpected<Error>(result.error());
  return milliseconds;
}

/// The CPU path, with all cores.
class HostBench : public BenchPlace {
 public:
  Result<void> for_each_pass(const BenchSubject& s, const std::string& only,
                             const std::function<Result<void>(const BenchPass&)>& use) override {
    const BenchBytes bytes(s);
    // Into memory that is there already, as an engine has it: the passes are timed and not the system's
    // pages.
    std::vector<Vec3> at_vertices(s.mesh.vertex_count()), at_faces(s.mesh.face_count());
    const auto normals = [&](NormalWeights weights) {
      return [&s, &at_vertices, weights] {
        return timed([&] { return vertex_normals(s.mesh, s.positions, at_vertices, {weights}); });
      };
    };
    const auto steps = [&s](LaplacianSmoothingOptions options) {
      return [&s, options]() -> Result<double> {
        VKMESH_TRY(const double all,
                   timed([&] { return laplacian_smoothing(s.neighbours, s.positions, options); }));
        return all / kBenchSteps;
      };
    };
    const BilateralWidth width = bench_widths(s);
    const CollapseCostOptions frame = unit_frame(s.positions);
    std::vector<BenchPass> passes = {
        {"triangle normals", bytes.triangle_normals,
         [&] { return timed([&] { return triangle_normals(s.mesh, s.positions, at_faces); }); }},
        {"vertex normals", bytes.vertex_normals, normals(NormalWeights::kArea)},
        {"vertex normals by angle", bytes.vertex_normals, normals(NormalWeights::kAngle)},
        {"dihedral angles", bytes.dihedral_angles,
         [&s] { return timed([&] { return dihedral_angles(s.mesh, s.positions); }); }},
        {"curvatures", bytes.curvatures,
         [&s] { return timed([&] { return curvatures(s.neighbours, s.positions); }); }},
        {"Laplacian step", bytes.smoothing_step, steps({.iterations = kBenchSteps})},
        {"cotangent step", bytes.smoothing_step,
         steps({.iterations = kBenchSteps, .weights = SmoothingWeights::kCotangent})},
        {"area and volume", bytes.measures,
         [&s] { return timed([&] { return surface_measures(s.mesh, s.positions); }); }},
        {"quadrics and collapse costs", bytes.collapse_costs,
         [&s, frame] {
           return timed([&]() -> Result<std::vector<float>> {
             VKMESH_TRY(const std::vector<VertexQuadric> planes, quadrics(s.mesh, s.positions, frame));
             return collapse_costs(s.mesh, s.positions, planes, frame);
           });
         }},
        {"swap scores", bytes.swap_scores,
         [&s] { return timed([&] { return swap_scores(s.mesh, s.positions); }); }},
        {"bilateral smoothing", bytes.bilateral_smoothing,
         [&s, width] {
           return timed([&] {
             return bilateral_smoothing(s.mesh, s.positions, {width.spatial, width.influence});
           });
         }},
    };
    // All cores. Removed is nine tenths of the vertices, so the time of a triangle tells that of a removal.
    for (const auto& [name, operation] :
         {std::pair("decimation by edge collapses", DecimateOperation::kEdgeCollapse),
          std::pair("decimation by half-edge collapses", DecimateOperation::kHalfEdgeCollapse),
          std::pair("decimation by vertex removals", DecimateOperation::kVertexRemoval)})
      passes.push_back({name, bytes.decimation, [&s, operation = operation] {
                          DecimateOptions options;
                          options.operation = operation;
                          options.target_ratio = kBenchRatio;
                          return timed([&] { return decimate({s.positions, s.mesh.origins()}, options); });
                        }});
    for (const BenchPass& pass : passes)
      if (pass.name.find(only) != std::string::npos) VKMESH_CHECK(use(pass));
    return {};
  }

  Result<double> copy(std::uint64_t bytes) override {
    // Elsewhere each time, so that no cache holds the bytes.
    const std::size_t size = std::max<std::size_t>(bytes, std::size_t{1} << 28);
    if (from_.size() < size) {
      from_.assign(size, std::byte{1});
      to_.assign(size, std::byte{2});
    }
    if (place_ + bytes > from_.size()) place_ = 0;
    const std::byte* from = from_.data() + place_;
    std::byte* to = to_.data() + place_;
    place_ += bytes;
    return timed([&]() -> Result<int> {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bytes, 1 << 18), [&](const auto& range) {
        std::memcpy(to + range.begin(), from + range.begin(), range.size());
      });
      return 0;
    });
  }

 private:
  std::vector<std::byte> from_, to_;
  std::size_t place_ = 0;
};

Result<BenchSubject> subject_of(const IndexedFaceSet& triangles) {
  BenchSubject subject;
  VKMESH_TRY(subject.mesh, to_half_edge_mesh(triangles));
  VKMESH_TRY(subject.neighbours, node_neighbours(subject.mesh));
  subject.positions = triangles.points;
  return subject;
}

/// Each triangle cut into four at the middles of its edges; points in the order in which triangles meet them,
/// as in files of scans.
IndexedFaceSet split(const BenchSubject& subject) {
  const HalfEdgeMesh& mesh = subject.mesh;
  IndexedFaceSet result;
  result.corners.reserve(4 * mesh.half_edge_count());
  std::vector<std::uint32_t> corner(mesh.vertex_count(), kInvalid), middle(mesh.half_edge_count(), kInvalid);
  const auto add = [&](std::uint32_t& number, Vec3 point) {
    if (number != kInvalid) return;
    number = static_cast<std::uint32_t>(result.points.size());
    result.points.push_back(point);
  };
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
      const std::uint32_t from = mesh.origins()[h], to = mesh.target(HalfEdgeId(h)).index;
      add(corner[from], subject.positions[from]);
      add(middle[h], 0.5f * (subject.positions[from] + subject.positions[to]));
      if (const std::uint32_t twin = mesh.twins()[h]; twin != kInvalid) middle[twin] = middle[h];
    }
    const std::uint32_t h = 3 * f, a = corner[mesh.origins()[h]], b = corner[mesh.origins()[h + 1]],
                        c = corner[mesh.origins()[h + 2]];
    const std::uint32_t ab = middle[h], bc = middle[h + 1], ca = middle[h + 2];
    for (const std::uint32_t v : {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca}) result.corners.push_back(v);
  }
  return result;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

struct Measured {
  std::vector<double> milliseconds;
  double copy = 0;
};

Result<Measured> measure(Job& job, BenchPlace& place, const BenchPass& pass, std::size_t repetitions) {
  Measured measured;
  std::vector<double> copies;
  // One to warm up; then in turns, so that what disturbs the machine disturbs both.
  for (std::size_t i = 0; i <= repetitions; ++i) {
    if (!job.progress(pass.name)(static_cast<double>(i) / static_cast<double>(repetitions + 1)))
      return fail(ErrorCode::kInterrupted, "interrupted");
    VKMESH_TRY(const double milliseconds, pass.run());
    VKMESH_TRY(const double copy, place.copy(pass.bytes));
    if (i == 0) continue;
    measured.milliseconds.push_back(milliseconds);
    copies.push_back(copy);
  }
  measured.copy = median(copies);
  return measured;
}

std::string columns(const char* pattern, double a, double b, double c, double d) {
  char text[96];
  std::snprintf(text, sizeof text, pattern, a, b, c, d);
  return text;
}

class Bench {
 public:
  Bench(Job& job, BenchPlace& place, const BenchOptions& options)
      : job_(job), place_(place), options_(options), rows_(job.json()["result"]["rows"] = Json::array()) {}

  Result<void> measure_all(const std::string& file, const BenchSubject& subject) {
    const auto triangles = static_cast<double>(subject.mesh.face_count());
    job_.row(grouped(subject.mesh.face_count()) + " triangles", "median ms  ns/triangle      GB/s  x copy");
    return place_.for_each_pass(subject, options_.only, [&](const BenchPass& pass) -> Result<void> {
      VKMESH_TRY(const Measured measured, measure(job_, place_, pass, options_.repetitions));
      const double ms = median(measured.milliseconds), each = 1e6 * ms / triangles,
                   rate = static_cast<double>(pass.bytes) / ms / 1e6, ratio = ms / measured.copy;
      job_.row("  " + pass.name, columns("%9.3f  %11.2f  %8.2f  %6.2f", ms, each, rate, ratio));
      rows_.push_back({{"file", file},
                       {"triangles", subject.mesh.face_count()},
                       {"vertices", subject.mesh.vertex_count()},
                       {"pass", pass.name},
                       {"milliseconds", measured.milliseconds},
                       {"median_ms", ms},
                       {"ns_per_triangle", each},
                       {"bytes", pass.bytes},
                       {"copy_ms", measured.copy},
                       {"times_copy", ratio},
                       {"share_of_copy_bandwidth", 0.5 / ratio}});
      per_triangle_[pass.name].push_back(each);
      return {};
    });
  }

  /// How the time of a triangle changes from size to size.
  void report_growth() {
    Json& growth = job_.json()["result"]["growth"] = Json::object();
    if (per_triangle_.empty() || per_triangle_.begin()->second.size() < 2) return;
    job_.row("growth", "largest over smallest time per triangle of all sizes");
    for (const auto& [name, times] : per_triangle_) {
      const auto [least, most] = std::minmax_element(times.begin(), times.end());
      growth[name] = *most / *least;
      job_.row("  " + name, columns("%9.2f", *most / *least, 0, 0, 0));
    }
  }

 private:
  Job& job_;
  BenchPlace& place_;
  const BenchOptions& options_;
  Json& rows_;
  std::map<std::string, std::vector<double>> per_triangle_;
};

Result<std::unique_ptr<BenchPlace>> open_place(Job& job) {
#ifdef VKMESH_HAS_VULKAN
  const std::string& asked = job.options().device;
  if (asked != "cpu") {
    auto vulkan = open_vulkan_bench(job, asked);
    if (vulkan || asked != "auto" || vulkan.error().code != ErrorCode::kNoDevice) return vulkan;
  }
#endif
  use_host(job);
  job.row("device", "cpu");
  return std::make_unique<HostBench>();
}

Result<void> run(Job& job, const BenchOptions& options) {
  VKMESH_TRY(const std::unique_ptr<BenchPlace> place, open_place(job));
  Bench bench(job, *place, options);
  for (const std::string& file : options.files) {
    VKMESH_TRY(MeshFile read, job.timed("read", [&] {
      return read_mesh(file, ReadOptions{job.progress("reading"), DVec3(0.0), true});
    }));
    VKMESH_TRY(BenchSubject subject, job.timed("consolidate", [&]() -> Result<BenchSubject> {
      VKMESH_TRY(const IndexedFaceSet polygons, to_indexed_face_set(std::move(read)));
      VKMESH_TRY(Triangulated cut, triangulate(polygons));
      VKMESH_TRY(Consolidated made, consolidate(std::move(cut.mesh), job.options().consolidation));
      return subject_of(made.face_set);
    }));
    if (subject.mesh.face_count() == 0)
      return fail(ErrorCode::kUnsuitable, "no faces to measure with", {file, {}, {}});
    VKMESH_CHECK(bench.measure_all(file, subject));
    // The last file also in larger sizes.
    for (std::size_t i = 0; &file == &options.files.back() && i < options.splits; ++i) {
      VKMESH_TRY(subject, subject_of(split(subject)));
      VKMESH_CHECK(bench.measure_all(file, subject));
    }
  }
  bench.report_growth();
  return {};
}

}  // namespace

void add_bench(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("bench", "Times every pass on a device");
  command->footer(
      "For each mesh and pass: the median time, the same for a triangle, how many bytes a second go through "
      "that the\n"
      "pass must read or write at least, and how many times as long it takes as a plain copy of that many "
      "bytes on the\n"
      "same device. (On the host from memory, not from a cache. A copy reads and writes each byte: half the "
      "inverse is\n"
      "the share of its bandwidth.) Times are those of the device, without transfers. Smoothing: one step of "
      "ten in one\n"
      "submission. Bilateral: sigma_f of four mean edge lengths. Decimation: to a tenth, on the "
      "host's\n"
      "threads.\n\n"
      "Example:\n"
      "  vkmesh bench data/dragon/dragon_vrip_res3.ply.gz data/dragon/dragon_vrip.ply.gz --splits 2 --device "
      "cpu");
  add_common_options(*command, program.options, false, false);
  const auto options = std::make_shared<BenchOptions>();
  command->add_option("FILE", options->files, "Meshes, from small to large")->type_name("")->required();
  command
      ->add_option("--splits", options->splits,
                   "Also the last mesh with its triangles cut into four, so many times; default 0")
      ->type_name("N")
      ->check(count_up_to(6));
  command->add_option("--repetitions", options->repetitions, "Runs of each pass, from 1 to 1000; default 5")
      ->type_name("N")
      ->check(count_up_to(1000));
  command->add_option("--only", options->only, "Passes whose name holds this")->type_name("TEXT");
  command->callback([&program, options] {
    options->repetitions = std::max<std::size_t>(options->repetitions, 1);
    program.command = "bench";
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
