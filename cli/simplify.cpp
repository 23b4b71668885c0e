// vkmesh simplify: fewer triangles, by half-edge collapse with quadric error.
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include <vkmesh/decimation/decimate.h>

#include "backend.h"
#include "commands.h"

namespace vkmesh::cli {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

struct SimplifyOptions {
  std::optional<double> ratio;
  std::optional<std::size_t> faces;
  std::optional<double> error;
  double max_normal_deviation = DecimateOptions{}.max_normal_deviation / kRadians;
};

void say_what_is_lost(Job& job, const std::vector<Channel>& channels, const char* of) {
  for (const Channel& channel : channels)
    job.note("the attribute " + channel.name + " of " + of +
             " was left out: faces do not outlive simplification");
}

std::string why(DecimateStop stop, const SimplifyOptions& options) {
  switch (stop) {
    case DecimateStop::kTargetReached:
      return "the target was reached";
    case DecimateStop::kErrorBound:
      return "the next collapse would exceed the error of " + brief(*options.error);
    case DecimateStop::kNoLegalCollapse:
      return "no collapse is left that keeps the surface manifold and folds no face over";
  }
  return {};
}

Result<void> run(Job& job, const SimplifyOptions& options) {
  if (!options.ratio && !options.faces && !options.error)
    return fail(ErrorCode::kUsage, "say when to stop: --ratio, --faces or --error");
  use_host(job);
  VKMESH_CHECK(job.check_output());
  VKMESH_TRY(IndexedFaceSet mesh, job.read());
  if (!mesh.is_triangles()) job.note("polygons were cut into triangles");
  VKMESH_TRY(HalfEdgeMesh half_edges, job.consolidate_triangles(mesh));
  say_what_is_lost(job, mesh.corner_channels, "corners");
  say_what_is_lost(job, mesh.face_channels, "faces");
  // The half-edges hold the corners from here on; what is let go now keeps the peak of memory low.
  IndexedFaceSet input;
  std::swap(input.points, mesh.points);
  std::swap(input.point_channels, mesh.point_channels);
  mesh = {};

  const std::size_t faces = half_edges.face_count();
  DecimateOptions decimation;
  decimation.max_normal_deviation = options.max_normal_deviation * kRadians;
  decimation.max_error = options.error;
  if (options.faces) decimation.target_faces = *options.faces;
  if (options.ratio)
    decimation.target_faces =
        static_cast<std::size_t>(std::llround(*options.ratio * static_cast<double>(faces)));
  VKMESH_TRY(Decimated decimated, job.timed("compute", [&] {
    return decimate(half_edges, input.points, decimation, job.progress("simplifying"));
  }));
  half_edges = {};

  IndexedFaceSet output;
  output.points = std::move(decimated.positions);
  output.corners.assign(decimated.mesh.origins().begin(), decimated.mesh.origins().end());
  output.point_channels = gather(input.point_channels, decimated.source_vertex);
  const double ratio =
      faces == 0 ? 1.0 : static_cast<double>(output.face_count()) / static_cast<double>(faces);
  job.json()["result"] = {{"stop", name_of(decimated.stop)},
                          {"error", decimated.error},
                          {"ratio", ratio},
                          {"collapses", decimated.collapses},
                          {"rejected_link", decimated.rejected_link},
                          {"rejected_fold_over", decimated.rejected_fold_over}};
  job.row("simplified", "to " + brief(100 * ratio) + " % of " + count_of(faces, "triangle") +
                            "; largest error " + brief(decimated.error) + " in units of the file");
  job.row("stopped", why(decimated.stop, options));
  job.row("collapses", grouped(decimated.collapses) + " done; refused " + grouped(decimated.rejected_link) +
                           " that would break the manifold, " + grouped(decimated.rejected_fold_over) +
                           " that would fold a face over");
  return job.write(output);
}

}  // namespace

void add_simplify(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("simplify", "Reduces the number of triangles");
  command->footer(
      "The cheapest edge is collapsed into one of its ends, again and again, by quadric error. No new points "
      "are made;\n"
      "point attributes stay with their points. Runs on the host whatever --device says.\n\n"
      "Example:\n  vkmesh simplify data/dragon/dragon_vrip.ply.gz small.ply --ratio 0.1");
  add_common_options(*command, program.options, true, true);
  add_consolidate_options(*command, program.options);
  const auto options = std::make_shared<SimplifyOptions>();
  CLI::Option* ratio =
      command->add_option("--ratio", options->ratio, "Stop at this share of the triangles, from 0 to 1")
          ->type_name("R")
          ->check(number_between(0, 1));
  command->add_option("--faces", options->faces, "Stop at this number of triangles")
      ->check(count_up_to(std::numeric_limits<std::uint32_t>::max()))
      ->type_name("N")
      ->excludes(ratio);
  command
      ->add_option("--error", options->error,
                   "Stop before a collapse of a larger error, in units of the file's coordinates: the\n"
                   "root of the mean squared distance to the planes of the faces a point stands for")
      ->type_name("E")
      ->check(number_between(0, std::numeric_limits<double>::max()));
  command
      ->add_option("--max-normal-deviation", options->max_normal_deviation,
                   "Do no collapse that turns a remaining face by more than this, in degrees;\n"
                   "between 0 and 180, default 75")
      ->type_name("DEG")
      ->check(number_between(0, 180));
  command->callback([&program, options] {
    program.command = "simplify";
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
