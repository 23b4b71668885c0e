// vkmesh digest: 64-bit digests of what every pass computes, the same on every device.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/mesh/triangulate.h>

#include "commands.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct DigestOptions {
  std::vector<std::string> files;
  std::string check;
};

struct Line {
  std::string digest, pass, file;
};

/// FNV-1a (G. Fowler, L. C. Noll, K.-P. Vo): xor with each byte, times the prime of 64 bits; in hexadecimal.
template <class T>
std::string digest_of(const std::vector<T>& values) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::byte byte : std::as_bytes(std::span(values)))
    hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3u;
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

struct Input {
  HalfEdgeMesh mesh;
  std::vector<Vec3> positions;
};

struct Pass {
  std::string name;
  std::function<Result<std::string>(Backend&, const Input&)> digest;
};

template <class Compute>
Pass pass(std::string name, Compute compute) {
  return {std::move(name), [compute](Backend& backend, const Input& input) -> Result<std::string> {
            VKMESH_TRY(const auto values, compute(backend, input));
            return digest_of(values);
          }};
}

Pass normals(std::string name, NormalWeights weights) {
  return pass(std::move(name), [weights](Backend& b, const Input& in) {
    return b.vertex_normals(in.mesh, in.positions, {weights});
  });
}

Pass smoothing(std::string name, LaplacianSmoothingOptions options) {
  return pass(std::move(name), [options](Backend& b, const Input& in) {
    return b.laplacian_smoothing(in.mesh, in.positions, options, false);
  });
}

Pass collapse_costs(std::string name, CollapsePlacement placement) {
  return pass(std::move(name), [placement](Backend& b, const Input& in) {
    CollapseCostOptions options = unit_frame(in.positions);
    options.placement = placement;
    return b.collapse_costs(in.mesh, in.positions, options);
  });
}

Pass swap_scores(std::string name, SwapCriterion criterion) {
  return pass(std::move(name), [criterion](Backend& b, const Input& in) {
    return b.swap_scores(in.mesh, in.positions, criterion);
  });
}

const std::vector<Pass>& passes() {
  static const std::vector<Pass> all = {
      normals("vertex-normals", NormalWeights::kArea),
      normals("vertex-normals-by-angle", NormalWeights::kAngle),
      normals("vertex-normals-uniform", NormalWeights::kUniform),
      pass("triangle-normals",
           [](Backend& b, const Input& in) { return b.triangle_normals(in.mesh, in.positions); }),
      pass("dihedral-angles",
           [](Backend& b, const Input& in) -> Result<std::vector<float>> {
             VKMESH_TRY(DihedralAngles angles, b.dihedral_angles(in.mesh, in.positions));
             // Of half-edges, then of vertices.
             angles.half_edge.insert(angles.half_edge.end(), angles.vertex_maximum.begin(),
                                     angles.vertex_maximum.end());
             return std::move(angles.half_edge);
           }),
      pass("curvatures", [](Backend& b, const Input& in) { return b.curvatures(in.mesh, in.positions); }),
      pass("surface-measures",
           [](Backend& b, const Input& in) -> Result<std::vector<SurfaceMeasures>> {
             VKMESH_TRY(const SurfaceMeasures measures, b.surface_measures(in.mesh, in.positions));
             return std::vector{measures};
           }),
      collapse_costs("collapse-costs", CollapsePlacement::kOptimal),
      collapse_costs("collapse-costs-end", CollapsePlacement::kEndpoint),
      swap_scores("swap-scores", SwapCriterion::kMinAngle),
      swap_scores("swap-scores-by-quality", SwapCriterion::kAspectRatio),
      smoothing("laplacian-smoothing", {}),
      smoothing("taubin-smoothing", {.mu = -0.53f}),
      smoothing("cotangent-smoothing", {.weights = SmoothingWeights::kCotangent}),
      smoothing("cotangent-taubin-along-boundary", {.boundary = SmoothingBoundary::kAlongItself,
                                                    .weights = SmoothingWeights::kCotangent,
                                                    .mu = -0.53f}),
      pass("laplacian-smoothing-keeping-volume",
           [](Backend& b, const Input& in) {
             return b.laplacian_smoothing(in.mesh, in.positions, {.iterations = 3},
                                          in.mesh.boundary_half_edge_count() == 0);
           }),
      pass("bilateral-smoothing",
           [](Backend& b, const Input& in) {
             const double length = mean_edge_length(in.mesh, in.positions);
             return b.bilateral_smoothing(
                 in.mesh, in.positions,
                 {.spatial = static_cast<float>(length), .influence = static_cast<float>(0.3 * length)},
                 false);
           }),
  };
  return all;
}

Result<Input> read_triangles(Job& job, const std::string& file) {
  VKMESH_TRY(MeshFile read, job.timed("read", [&] {
    return read_mesh(file, ReadOptions{job.progress("reading"), DVec3(0.0), true});
  }));
  return job.timed("consolidate", [&]() -> Result<Input> {
    VKMESH_TRY(const IndexedFaceSet polygons, to_indexed_face_set(std::move(read)));
    VKMESH_TRY(Triangulated cut, triangulate(polygons));
    VKMESH_TRY(Consolidated made, consolidate(std::move(cut.mesh), job.options().consolidation));
    return Input{std::move(made.mesh), std::move(made.face_set.points)};
  });
}

Result<std::vector<Line>> digests_of(Job& job, Backend& backend, const std::string& file) {
  VKMESH_TRY(const Input input, read_triangles(job, file));
  std::vector<Line> lines;
  for (const Pass& pass : passes()) {
    auto digest = pass.digest(backend, input);
    if (!digest) {
      if (digest.error().where.file.empty()) digest.error().where.file = file;
      return tl::unexpected<Error>(digest.error());
    }
    lines.push_back({*std::move(digest), pass.name, file});
  }
  return lines;
}

/// The lines of a list that begin with a digest; others are comments.
Result<std::vector<Line>> read_list(const std::string& path) {
  std::ifstream file(path);
  std::vector<Line> lines;
  for (std::string text; std::getline(file, text);) {
    const auto is_hexadecimal = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
    if (text.size() < 19 || text.substr(16, 2) != "  " ||
        !std::all_of(text.begin(), text.begin() + 16, is_hexadecimal))
      continue;
    const std::size_t space = text.find("  ", 18);
    if (space == std::string::npos) continue;
    const std::size_t name = text.find_first_not_of(' ', space);
    lines.push_back({text.substr(0, 16), text.substr(18, space - 18), text.substr(name)});
  }
  if (lines.empty())
    return fail(ErrorCode::kUnreadable, "holds no digests, or cannot be read", {path, {}, {}});
  return lines;
}

Result<void> run(Job& job, const DigestOptions& options) {
  if (options.files.empty() == options.check.empty())
    return fail(ErrorCode::kUsage, "name files, or a list to --check");
  std::vector<Line> expected;
  std::vector<std::string> files = options.files;
  if (!options.check.empty()) {
    VKMESH_TRY(expected, read_list(options.check));
    for (const Line& line : expected)
      if (std::find(files.begin(), files.end(), line.file) == files.end()) files.push_back(line.file);
  }
  VKMESH_TRY(const std::unique_ptr<Backend> backend, open_backend(job));
  Json& list = job.json()["result"]["digests"] = Json::array();
  std::vector<Line> lines;
  for (const std::string& file : files) {
    VKMESH_TRY(std::vector<Line> some, digests_of(job, *backend, file));
    std::move(some.begin(), some.end(), std::back_inserter(lines));
  }
  std::size_t width = 0;
  for (const Line& line : lines) width = std::max(width, line.pass.size());
  for (const Line& line : lines) {
    list.push_back({{"file", line.file}, {"pass", line.pass}, {"digest", line.digest}});
    if (options.check.empty())
      job.row(line.digest, line.pass + std::string(width + 2 - line.pass.size(), ' ') + line.file);
  }
  if (options.check.empty()) return {};

  std::string differing;
  std::size_t differences = 0;
  for (const Line& line : expected) {
    const auto found = std::find_if(lines.begin(), lines.end(), [&](const Line& l) {
      return l.file == line.file && l.pass == line.pass;
    });
    if (found != lines.end() && found->digest == line.digest) continue;
    if (differences++ == 0)
      differing = line.pass + " of " + line.file + ", " +
                  (found == lines.end() ? "no such pass" : found->digest) + " for " + line.digest;
  }
  job.json()["result"]["differences"] = differences;
  job.row("digests", grouped(expected.size()) + " checked, " + grouped(files.size()) + " files");
  if (differences == 0) return {};
  return fail(ErrorCode::kUnsuitable,
              count_of(differences, "digest") + " of " + grouped(expected.size()) +
                  (differences == 1 ? " differs: " : " differ, first ") + differing,
              {options.check, {}, {}});
}

}  // namespace

void add_digest(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("digest", "Digests of what every pass computes of meshes");
  command->footer(
      "One line for each pass and file: 64 bits (FNV-1a) over the bytes of the result. They are the same on "
      "every device,\nwith every compiler and any number of threads; --check compares with a list of such "
      "lines "
      "and fails (exit code 4)\nwhere one differs. Polygons are cut into triangles, and what is no manifold "
      "is "
      "mended first.\n\n"
      "Example:\n  vkmesh digest data/cgal/meshes/elephant.off --device cpu");
  add_common_options(*command, program.options, false, false);
  const auto options = std::make_shared<DigestOptions>();
  command->add_option("FILE", options->files, "Meshes")->type_name("");
  command->add_option("--check", options->check, "A list of digests to compare with, and the files it names")
      ->type_name("LIST");
  command->callback([&program, options] {
    program.command = "digest";
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
