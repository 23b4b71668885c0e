// vkmesh lod: levels of detail.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/lod/lod_chain.h>
#include <vkmesh/math/bounds.h>

#include "commands.h"
#include "commands/simplify/decimation_input.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct LodOptions : DecimationChoice {
  std::size_t levels = 0;
  double reduction = LodChainOptions{}.reduction;
  std::vector<double> ratios, errors, relative_errors;
  std::string layout, vertices;
  bool measure = false, vertex_cache = false;
  std::optional<double> time_limit;
};

/// NAME of "folder/NAME.ply.gz", and ".ply.gz".
std::pair<std::string, std::string> parts_of_name(const std::string& output) {
  std::filesystem::path name = std::filesystem::path(output).filename();
  std::string extension;
  if (name.extension() == ".gz") {
    extension = ".gz";
    name.replace_extension();
  }
  extension = name.extension().string() + extension;
  name.replace_extension();
  return {name.string(), extension};
}

Result<LodChainOptions> chain_options(const LodOptions& options) {
  const std::size_t ways = (options.levels > 0 ? 1u : 0u) + (options.ratios.empty() ? 0u : 1u) +
                           (options.errors.empty() ? 0u : 1u) + (options.relative_errors.empty() ? 0u : 1u);
  if (ways != 1)
    return fail(ErrorCode::kUsage,
                "say which levels, one way: --levels, --ratios, --errors or --relative-errors");
  if (options.vertices == "shared" && !options.points_stay())
    return fail(ErrorCode::kUsage,
                "--vertices shared: edge collapses move points, so that levels cannot share them; add "
                "--operation half-edge-collapse");
  if (options.vertex_cache && !has_vertex_cache_order())
    return fail(ErrorCode::kUsage,
                "--vertex-cache: this vkmesh was built without meshoptimizer (Debian: libmeshoptimizer-dev)");
  LodChainOptions chain;
  chain.count = options.levels;
  chain.reduction = options.reduction;
  chain.ratios = options.ratios;
  for (const double error : options.errors) chain.errors.push_back(Length::absolute(error));
  for (const double error : options.relative_errors) chain.errors.push_back(Length::relative(error));
  chain.vertices = options.vertices == "shared" || (options.vertices.empty() && options.points_stay())
                       ? LodVertices::kShared
                       : LodVertices::kOwn;
  chain.optimize = options.vertex_cache;
  chain.measure = options.measure;
  // Bounds of the Hausdorff distance, as `compare` has them.
  chain.measuring.hausdorff_tolerance = 0.01;
  return chain;
}

/// For each level the least share of the screen at which it is to be shown: where the error of the next one
/// is a pixel on a screen of 1080 lines, the bounding box being as high as the picture; and at most the share
/// of the faces that the next one has, so that levels close to each other all have their turn. The last is
/// shown however small.
std::vector<double> screen_coverage(const LodChain& chain) {
  constexpr double kLines = 1080;
  std::vector<double> coverage;
  const auto faces = [&](std::size_t k) { return static_cast<double>(chain.levels[k].mesh.face_count()); };
  for (std::size_t k = 0; k + 1 < chain.levels.size(); ++k) {
    const double height = 1 / (kLines * std::max(chain.levels[k + 1].relative_error, 1e-9));
    coverage.push_back(std::min(height * height, faces(k + 1) / faces(0)));
  }
  coverage.push_back(0);
  return coverage;
}

/// What a level has, for the table and for JSON.
void report(Job& job, const LodChain& chain, double diagonal) {
  Json levels = Json::array();
  const std::vector<double> coverage = screen_coverage(chain);
  for (std::size_t k = 0; k < chain.levels.size(); ++k) {
    const LodLevel& level = chain.levels[k];
    const std::size_t loops = level.mesh.boundary_loops().size();
    std::string text = count_of(level.mesh.face_count(), "triangle") + ", " +
                       count_of(level.positions.size(), "point") + ", " + count_of(loops, "boundary loop");
    Json entry = {{"faces", level.mesh.face_count()},
                  {"points", level.positions.size()},
                  {"vertices", level.attributes.corners.empty() ? level.positions.size()
                                                                : level.attributes.source_corner.size()},
                  {"boundary_loops", loops},
                  {"error", level.error},
                  {"relative_error", level.relative_error},
                  {"attribute_error", level.attribute_error},
                  {"distance_bound", level.distance_bound ? Json(*level.distance_bound) : Json(nullptr)},
                  {"screen_coverage", coverage[k]},
                  {"measured", nullptr}};
    if (!level.attributes.corners.empty())
      text += ", " + count_of(level.attributes.source_corner.size(), "vertex", "vertices");
    if (k > 0) text += "; error " + brief(100 * level.relative_error) + " % of the diagonal";
    if (level.distance_bound && k > 0) text += ", no point farther than " + brief(*level.distance_bound);
    if (level.distance && k > 0) {
      const DistanceSummary measured = level.distance->two_sided();
      entry["measured"] = {{"mean", measured.mean},
                           {"root_mean_square", measured.root_mean_square},
                           {"hausdorff_low", measured.hausdorff_low},
                           {"hausdorff_high", measured.hausdorff_high}};
      text += "; measured: mean " + brief(100 * measured.mean / diagonal) + " %, farthest " +
              brief(100 * measured.hausdorff_high / diagonal) + " %";
    }
    levels.push_back(std::move(entry));
    job.row("level " + std::to_string(k), text);
  }
  job.json()["result"]["levels"] = std::move(levels);
}

Result<void> run(Job& job, const LodOptions& options) {
  VKMESH_TRY(LodChainOptions chain_asked, chain_options(options));
  use_host(job);
  VKMESH_CHECK(job.check_output());
  const auto [name, extension] = parts_of_name(job.options().output);
  const bool is_gltf = extension == ".glb" || extension == ".gltf";
  const std::string layout = !options.layout.empty() ? options.layout : is_gltf ? "nodes" : "files";
  if (layout != "files" && !is_gltf)
    return fail(ErrorCode::kUsage,
                "--layout " + layout + " is one of glTF files: OUT must be a .glb or .gltf");
  if (layout == "files" && job.options().output == "-")
    return fail(ErrorCode::kUsage, "levels in files of their own need a name for OUT, not -");

  VKMESH_TRY(DecimationInput input, DecimationInput::read(job, options, false));
  const bool shared = chain_asked.vertices == LodVertices::kShared;
  chain_asked.decimate = input.options();
  chain_asked.decimate.target.seconds = input.seconds_left(options.time_limit);
  const std::size_t isolated = isolated_points(input.half_edges, input.points.size()).size();
  VKMESH_TRY(const LodChain chain, job.timed("compute", [&] {
    return lod_chain({input.points, input.half_edges.origins()}, chain_asked, job.progress("making levels"));
  }));
  input.half_edges = {};

  Bounds bounds;
  for (const Vec3& p : chain.levels.front().positions) bounds.add(p);
  job.json()["result"] = {{"operation", options.operation},
                          {"layout", layout},
                          {"vertices", shared ? "shared" : "own"},
                          {"stop", name_of(chain.last.stop)},
                          {"levels", nullptr}};
  report(job, chain, bounds.diagonal());
  if (isolated > 0)
    VKMESH_CHECK(
        job.note_dropped("isolated_points", count_of(isolated, "point") + " that no face uses left out"));
  if (!options.points_stay()) {
    std::string unmixed;
    for (const std::string& channel : input.attributes.unmixed_points())
      unmixed += (unmixed.empty() ? "" : ", ") + channel;
    if (!unmixed.empty())
      job.note("points were moved: each has the " + unmixed + " of a point that it stands for");
  }
  const bool met = chain.last.stop == DecimateStop::kTargetReached ||
                   (chain.last.stop == DecimateStop::kErrorBound && !chain_asked.errors.empty());
  if (!met)
    job.row("stopped", "the next level is not reached (" + name_of(chain.last.stop) +
                           "): " + describe(chain.last.blocked));

  std::vector<IndexedFaceSet> levels;
  std::vector<std::filesystem::path> files;
  const std::filesystem::path folder = std::filesystem::path(job.options().output).parent_path();
  for (std::size_t k = 0; k < chain.levels.size(); ++k) {
    IndexedFaceSet& level = levels.emplace_back();
    level.corners.assign(chain.levels[k].mesh.origins().begin(), chain.levels[k].mesh.origins().end());
    level.points = chain.levels[k].positions;
    input.attributes.give(chain.levels[k], level);
    files.push_back(folder / (name + "_lod" + std::to_string(k) + extension));
  }
  if (layout == "files") return job.write_levels(std::move(levels), std::nullopt, files);
  LevelWriteOptions one_file;
  one_file.layout = layout == "msft" ? LevelLayout::kMsftLod : LevelLayout::kNodes;
  one_file.name = name;
  one_file.shared_points = shared;
  one_file.screen_coverage = screen_coverage(chain);
  return job.write_levels(std::move(levels), one_file, {});
}

}  // namespace

void add_lod(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("lod", "Makes levels of detail");
  command->footer(
      "Level 0 is IN; each further level has fewer triangles, as 'simplify' makes them, and goes on from the "
      "one\n"
      "before. OUT names the files NAME_lod0.ply, NAME_lod1.ply and so on beside it; or it is one glTF "
      "file.\n"
      "Runs on the host whatever --device says.\n\n"
      "Examples:\n"
      "  vkmesh lod data/dragon/dragon_vrip_res3.ply.gz dragon.glb --levels 5\n"
      "  vkmesh lod data/dragon/dragon_vrip_res4.ply.gz dragon.ply --ratios 0.5,0.2,0.05 --measure\n"
      "  vkmesh lod data/cgal/meshes/elephant.off elephant.glb --layout msft --relative-errors "
      "1e-3,3e-3,1e-2\n"
      "  vkmesh lod data/cgal/meshes/elephant.off few.glb --levels 4 --operation half-edge-collapse");
  add_common_options(*command, program.options, true, true);
  add_consolidate_options(*command, program.options);
  add_keep_splits(*command, program.options);
  const auto options = std::make_shared<LodOptions>();
  LodOptions& o = *options;
  command
      ->add_option("--levels", o.levels,
                   "So many levels, IN being one; each has half as many triangles as the one before")
      ->type_name("N")
      ->check(count_between(1, 64));
  command
      ->add_option(
          "--reduction", o.reduction,
          "With --levels: the share of the triangles of the level before, between 0 and 1; default 0.5")
      ->type_name("R")
      ->check(number_between(0.001, 0.999))
      ->needs("--levels");
  command->add_option("--ratios", o.ratios, "The share of IN's triangles of level 1, 2 and so on, falling")
      ->type_name("R[,R...]")
      ->delimiter(',')
      ->check(number_between(0, 1));
  command
      ->add_option(
          "--errors", o.errors,
          "The largest error of level 1, 2 and so on, rising, in units of the file's coordinates: the\n"
          "root of the mean squared distance to the planes of the faces a point stands for")
      ->type_name("E[,E...]")
      ->delimiter(',')
      ->check(number_between(0, std::numeric_limits<double>::max()));
  command
      ->add_option("--relative-errors", o.relative_errors,
                   "The same as shares of the bounding box's diagonal")
      ->type_name("E[,E...]")
      ->delimiter(',')
      ->check(number_between(0, std::numeric_limits<double>::max()));
  command
      ->add_option("--layout", o.layout,
                   "files: NAME_lod0.EXT, NAME_lod1.EXT and so on beside OUT, NAME.EXT (default unless OUT\n"
                   "is glTF); nodes: one glTF file with nodes NAME_LOD0, NAME_LOD1, ... (default for glTF);\n"
                   "msft: one glTF file by the extension MSFT_lod, with screen coverages")
      ->type_name("NAME")
      ->check(CLI::IsMember({"files", "nodes", "msft"}));
  command
      ->add_option("--vertices", o.vertices,
                   "shared: the points of a level are the first of those of the level before, so that one\n"
                   "vertex buffer serves all (default where points stay); own: each level has its own")
      ->type_name("WHOSE")
      ->check(CLI::IsMember({"shared", "own"}));
  command->add_flag("--vertex-cache", o.vertex_cache,
                    "Order triangles for the vertex caches of a renderer, by the library meshoptimizer,\n"
                    "and points by first use");
  command->add_flag("--measure", o.measure,
                    "Measure how far each level lies from IN, as compare does; takes longer than all else");
  command
      ->add_option("--time-limit", o.time_limit,
                   "Stop so many seconds after IN has been read, with the levels that are made by then")
      ->type_name("S")
      ->check(number_between(0, std::numeric_limits<double>::max()));
  add_decimation_options(*command, options);
  command->callback([&program, options] {
    program.command = "lod";
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
