// vkmesh simplify: fewer triangles, by quadric error.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/decimation/decimate.h>

#include "commands.h"
#include "commands/simplify/decimation_input.h"
#include "commands/simplify/simplify_attributes.h"
#include "job/channels.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct SimplifyOptions : DecimationChoice {
  std::optional<double> ratio;
  std::optional<std::size_t> faces, vertices;
  std::optional<double> error, relative_error, time_limit;
  bool index_only = false;
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Which options free what seams block.
std::string how_to_free_seams(const SimplifyAttributes& attributes) {
  std::vector<std::string> options;
  for (const std::string& name : attributes.corner_names()) options.push_back("--drop-attribute " + name);
  if (!attributes.borders().empty()) options.emplace_back("--no-material-borders");
  return options.empty() ? std::string() : "; " + joined(options) + " would free seams";
}

std::string why(const DecimationReport& report, const SimplifyOptions& options,
                const SimplifyAttributes& attributes) {
  const CountByReason& blocked = report.blocked;
  switch (report.stop) {
    case DecimateStop::kTargetReached:
      return "the target was reached";
    case DecimateStop::kErrorBound:
      return "the error of " +
             (options.error ? brief(*options.error)
                            : brief(100 * options.relative_error.value_or(0)) + " % of the diagonal") +
             " holds what is left: " + describe(blocked);
    case DecimateStop::kTimeLimit:
      return report.collapses > 0 ? "the time was up"
                                  : "the time was up before the first collapse: OUT is the surface of IN";
    case DecimateStop::kOutOfProportion:
      return "the target is out of reach, and more would take the shape of all that may go (--force-target "
             "goes "
             "on): " +
             describe(blocked) + (blocked[Reason::kSeam] > 0 ? how_to_free_seams(attributes) : std::string());
    case DecimateStop::kNoLegalCollapse:
      return "what is left is illegal: " + describe(blocked) +
             (blocked[Reason::kSeam] > 0 ? how_to_free_seams(attributes) : std::string());
  }
  return {};
}

Result<void> run(Job& job, const SimplifyOptions& options) {
  if (!options.ratio && !options.faces && !options.vertices && !options.error && !options.relative_error &&
      !options.time_limit)
    return fail(ErrorCode::kUsage,
                "say when to stop: --ratio, --faces, --vertices, --error, --relative-error or --time-limit");
  const bool points_stay = options.points_stay();
  if (options.index_only && !points_stay)
    return fail(ErrorCode::kUsage,
                "--index-only leaves all points where they are: add --operation half-edge-collapse");
  use_host(job);
  VKMESH_CHECK(job.check_output());
  VKMESH_TRY(DecimationInput input, DecimationInput::read(job, options, options.index_only));
  DecimateOptions decimation = input.options();
  decimation.bounds.error = length_of(options.error, options.relative_error);
  decimation.target.faces = options.faces;
  decimation.target.vertices = options.vertices;
  decimation.target.ratio = options.ratio;
  SimplifyAttributes& attributes = input.attributes;
  HalfEdgeMesh& half_edges = input.half_edges;
  const std::vector<Vec3>& points = input.points;

  const std::size_t faces = half_edges.face_count();
  const std::vector<std::uint32_t> isolated = isolated_points(half_edges, points.size());
  decimation.target.seconds = input.seconds_left(options.time_limit);
  VKMESH_TRY(Decimated decimated, job.timed("compute", [&] {
    return decimate(half_edges, points, decimation, job.progress("simplifying"));
  }));
  half_edges = {};

  IndexedFaceSet output;
  output.corners.assign(decimated.mesh.origins().begin(), decimated.mesh.origins().end());
  if (options.index_only) {
    for (std::size_t c = 0; c < output.corners.size(); ++c)
      output.corners[c] =
          input.vertex_of_corner[decimated.attributes.source_corner[decimated.attributes.corners[c]]];
    output.points = std::move(input.buffer.points);
    output.point_channels = std::move(input.buffer.channels);
    attributes.give_index_only(decimated, output);
  } else {
    output.points = std::move(decimated.positions);
    attributes.give(decimated, output);
    attributes.append_points(isolated, output);
    for (const std::uint32_t p : isolated) output.points.push_back(points[p]);
    if (const auto unmixed = attributes.unmixed_points(); !unmixed.empty() && !points_stay)
      job.note("points were moved: each has the " + joined(unmixed) + " of a point that it stands for");
  }
  const double ratio =
      faces == 0 ? 1.0 : static_cast<double>(output.face_count()) / static_cast<double>(faces);
  Json blocked;
  for (const ReasonText& r : kReasonTexts) blocked[r.name] = decimated.blocked[r.reason];
  Json& result = job.json()["result"];
  result = {{"stop", name_of(decimated.stop)},
            {"operation", options.operation},
            {"error", decimated.error},
            {"relative_error", decimated.relative_error},
            {"attributes", attributes.names()},
            {"attribute_error", decimated.attribute_error},
            {"ratio", ratio},
            {"collapses", decimated.collapses},
            {"pruned_components", decimated.pruned_components},
            {"pruned_faces", decimated.pruned_faces},
            {"held", blocked},
            {"distance_bound", decimated.distance_bound ? Json(*decimated.distance_bound) : Json(nullptr)}};
  for (const ReasonText& r : kReasonTexts)
    if (r.reason != Reason::kBoundary)  // counts as locked
      result[std::string("rejected_") + r.name] = decimated.rejected[r.reason];
  job.row("simplified", "to " + brief(100 * ratio) + " % of " + count_of(faces, "triangle") +
                            "; largest error " + brief(decimated.error) + " in units of the file, " +
                            brief(100 * decimated.relative_error) + " % of the diagonal");
  if (decimated.distance_bound)
    job.row("distance", "no point of either surface is farther than " + brief(*decimated.distance_bound) +
                            " from the other");
  if (decimated.pruned_components > 0)
    job.row("pruned", count_of(decimated.pruned_components, "component") + " of " +
                          count_of(decimated.pruned_faces, "triangle"));
  if (!isolated.empty())
    job.row("isolated",
            count_of(isolated.size(), "point") + " that no face uses kept (--drop-isolated leaves them out)");
  job.row("stopped", why(decimated, options, attributes));
  job.row("collapses",
          grouped(decimated.collapses) + " done; refused " +
              grouped(decimated.rejected[Reason::kLinkCondition]) + " that would break the manifold, " +
              grouped(decimated.rejected[Reason::kFoldOver]) + " that would fold a face over" +
              (attributes.names().empty()
                   ? std::string()
                   : ", " + grouped(decimated.rejected[Reason::kSeam]) + " that would break a seam"));
  if (!attributes.names().empty())
    job.row("attributes", joined(attributes.names()) + "; largest weighted error " +
                              brief(decimated.attribute_error) + ", as a share of the ranges");
  return job.write(output);
}

}  // namespace

void add_simplify(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("simplify", "Reduces the number of triangles");
  command->footer(
      "The cheapest edge is collapsed, again and again, by quadric error; the first rule met stops it. "
      "Attributes\n"
      "of points and corners, as texture coordinates, are made to fit, borders between materials keep their "
      "shape.\n"
      "Runs on the host whatever --device says.\n\n"
      "Examples:\n"
      "  vkmesh simplify data/dragon/dragon_vrip.ply.gz small.ply --ratio 0.1\n"
      "  vkmesh simplify data/dragon/dragon_vrip.ply.gz near.ply --relative-error 1e-4 --boundary kept\n"
      "  vkmesh simplify data/dragon/dragon_vrip.ply.gz few.ply --vertices 5000 --operation "
      "half-edge-collapse\n"
      "  vkmesh simplify data/dragon/dragon_vrip_res2.ply.gz best.ply --ratio 0.1 --operation "
      "vertex-removal\n"
      "  vkmesh simplify data/dragon/dragon_vrip_res2.ply.gz one.ply --ratio 0.1 --prune-relative-size 0.01\n"
      "  vkmesh simplify data/cgal/meshes/fandisk.off part.ply --ratio 0.05 --crease-angle 40\n"
      "  vkmesh simplify data/dragon/dragon_vrip_res2.ply.gz true.ply --ratio 0.2 --max-relative-distance "
      "1e-3\n"
      "  vkmesh simplify data/cgal/meshes/elephant.off even.ply --ratio 0.2 --criterion aspect-ratio=0.1 "
      "--max-valence 8\n"
      "  vkmesh simplify data/cgal/meshes/mesh_with_colors.off painted.ply --faces 3 --attribute color=0.05\n"
      "  vkmesh simplify data/dragon/dragon_vrip_res3.ply.gz level.ply --ratio 0.5 --operation "
      "half-edge-collapse --index-only");
  add_common_options(*command, program.options, true, true);
  add_consolidate_options(*command, program.options);
  add_keep_splits(*command, program.options);
  const auto options = std::make_shared<SimplifyOptions>();
  command->add_flag("--index-only", options->index_only,
                    "Keep all points of the file as they are and where they are in it, and write fewer\n"
                    "triangles over them: for half-edge collapses and vertex removal");
  CLI::Option* ratio =
      command->add_option("--ratio", options->ratio, "Stop at this share of the triangles, from 0 to 1")
          ->type_name("R")
          ->check(number_between(0, 1));
  command->add_option("--faces", options->faces, "Stop at this number of triangles")
      ->check(count_up_to(std::numeric_limits<std::uint32_t>::max()))
      ->type_name("N")
      ->excludes(ratio);
  command->add_option("--vertices", options->vertices, "Stop at this number of points")
      ->check(count_up_to(std::numeric_limits<std::uint32_t>::max()))
      ->type_name("N");
  CLI::Option* relative_error =
      command
          ->add_option("--relative-error", options->relative_error,
                       "Do no collapse of a larger error, as a share of the bounding box's diagonal")
          ->type_name("E")
          ->check(number_between(0, std::numeric_limits<double>::max()));
  command
      ->add_option("--time-limit", options->time_limit,
                   "Stop so many seconds after IN has been read; making OUT takes some more. Where they\n"
                   "pass before the first collapse, OUT is the surface of IN")
      ->type_name("S")
      ->check(number_between(0, std::numeric_limits<double>::max()));
  command
      ->add_option("--error", options->error,
                   "Do no collapse of a larger error, in units of the file's coordinates: the\n"
                   "root of the mean squared distance to the planes of the faces a point stands for")
      ->type_name("E")
      ->check(number_between(0, std::numeric_limits<double>::max()))
      ->excludes(relative_error);
  add_decimation_options(*command, options);
  command->callback([&program, options] {
    program.command = "simplify";
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
