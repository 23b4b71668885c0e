// vkmesh bench: times every pass, beside a plain copy of the bytes that it must touch.
#include "commands/bench/bench.h"

#include <algorithm>
#include <any>
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

#include "commands.h"
#include "passes/backend.h"

namespace vkmesh::cli {

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
  Result<Run> prepare(const PassRow& row, const PassInput& input) override {
    // Results go into memory that is there already, as an engine has it: the passes are timed and not the
    // system's pages.
    return Run([pass = row.pass(input), &input, output = std::any()]() mutable {
      return timed([&] { return pass.host(input, {}, output); });
    });
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

  [[nodiscard]] bool decimates() const override { return true; }

 private:
  std::vector<std::byte> from_, to_;
  std::size_t place_ = 0;
};

/// A mesh of one size.
struct BenchSubject {
  HalfEdgeMesh mesh;
  std::vector<Vec3> positions;
};

Result<BenchSubject> subject_of(const IndexedFaceSet& triangles) {
  BenchSubject subject;
  VKMESH_TRY(subject.mesh, to_half_edge_mesh(triangles));
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

Result<Measured> measure(Job& job, BenchPlace& place, const std::string& title, std::uint64_t bytes,
                         const BenchPlace::Run& run, std::size_t repetitions) {
  Measured measured;
  std::vector<double> copies;
  // One to warm up; then in turns, so that what disturbs the machine disturbs both.
  for (std::size_t i = 0; i <= repetitions; ++i) {
    if (!job.progress(title)(static_cast<double>(i) / static_cast<double>(repetitions + 1)))
      return fail(ErrorCode::kInterrupted, "interrupted");
    VKMESH_TRY(const double milliseconds, run());
    VKMESH_TRY(const double copy, place.copy(bytes));
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
    const PassInput input(subject.mesh, subject.positions);
    const PassBytes bytes(subject.mesh);
    job_.row(grouped(subject.mesh.face_count()) + " triangles", "median ms  ns/triangle      GB/s  x copy");
    for (const PassRow& row : pass_table()) {
      if (row.title.empty() || !wanted(row.title)) continue;
      VKMESH_TRY(const BenchPlace::Run run, place_.prepare(row, input));
      const BenchPlace::Run step = [&]() -> Result<double> {
        VKMESH_TRY(const double milliseconds, run());
        return milliseconds / row.steps;
      };
      VKMESH_CHECK(measure_one(file, subject, row.title, row.bytes(bytes), step));
    }
    if (!place_.decimates()) return {};
    // Removed is nine tenths of the vertices, so the time of a triangle tells that of a removal.
    const std::uint64_t in = bytes.points + bytes.corners;
    for (const auto& [title, operation] :
         {std::pair("decimation by edge collapses", DecimateOperation::kEdgeCollapse),
          std::pair("decimation by half-edge collapses", DecimateOperation::kHalfEdgeCollapse),
          std::pair("decimation by vertex removals", DecimateOperation::kVertexRemoval)}) {
      DecimateOptions options;
      options.operation = operation;
      options.target.ratio = 0.1;
      const auto run = [&] {
        return timed([&] { return decimate({subject.positions, subject.mesh.origins()}, options); });
      };
      if (wanted(title)) VKMESH_CHECK(measure_one(file, subject, title, in + in / 10, run));
    }
    return {};
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
  [[nodiscard]] bool wanted(const std::string& title) const {
    return title.find(options_.only) != std::string::npos;
  }

  Result<void> measure_one(const std::string& file, const BenchSubject& subject, const std::string& title,
                           std::uint64_t bytes, const BenchPlace::Run& run) {
    VKMESH_TRY(const Measured measured, measure(job_, place_, title, bytes, run, options_.repetitions));
    const auto triangles = static_cast<double>(subject.mesh.face_count());
    const double ms = median(measured.milliseconds), each = 1e6 * ms / triangles,
                 rate = static_cast<double>(bytes) / ms / 1e6, ratio = ms / measured.copy;
    job_.row("  " + title, columns("%9.3f  %11.2f  %8.2f  %6.2f", ms, each, rate, ratio));
    rows_.push_back({{"file", file},
                     {"triangles", subject.mesh.face_count()},
                     {"vertices", subject.mesh.vertex_count()},
                     {"pass", title},
                     {"milliseconds", measured.milliseconds},
                     {"median_ms", ms},
                     {"ns_per_triangle", each},
                     {"bytes", bytes},
                     {"copy_ms", measured.copy},
                     {"times_copy", ratio},
                     {"share_of_copy_bandwidth", 0.5 / ratio}});
    per_triangle_[title].push_back(each);
    return {};
  }

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
    (void)note_no_gpu(job, vulkan.error());
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
