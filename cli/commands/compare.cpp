// vkmesh compare: how far two surfaces lie from each other.
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/mesh/triangulate.h>

#include "commands.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct CompareOptions {
  std::string other;
  std::size_t samples = SurfaceDistanceOptions{}.samples;
  double tolerance = 1;  ///< Percent.
};

Json to_json(const DistanceSummary& d) {
  return {{"mean", d.mean},
          {"root_mean_square", d.root_mean_square},
          {"maximum", d.maximum},
          {"hausdorff_low", d.hausdorff_low},
          {"hausdorff_high", std::isfinite(d.hausdorff_high) ? Json(d.hausdorff_high) : Json(nullptr)},
          {"mean_normal_angle", d.mean_normal_angle},
          {"maximum_normal_angle", d.maximum_normal_angle}};
}

Result<IndexedFaceSet> triangles_of(const IndexedFaceSet& mesh) {
  VKMESH_TRY(Triangulated cut, triangulate(mesh));
  return std::move(cut.mesh);
}

Result<void> run(Job& job, const CompareOptions& options) {
  use_host(job);
  VKMESH_TRY(const IndexedFaceSet first, job.read());
  VKMESH_TRY(const IndexedFaceSet second, job.timed("read", [&]() -> Result<IndexedFaceSet> {
    VKMESH_TRY(MeshFile file, read_mesh(options.other, job.read_options()));
    VKMESH_CHECK(job.note_differences(options.other, file.notes));
    return to_indexed_face_set(std::move(file));
  }));
  job.row("second", options.other + "  (" + count_of(second.points.size(), "point") + ", " +
                        count_of(second.face_count(), "face") + ")");
  VKMESH_TRY(const IndexedFaceSet a, triangles_of(first));
  VKMESH_TRY(const IndexedFaceSet b, triangles_of(second));
  SurfaceDistanceOptions sampling;
  sampling.samples = options.samples;
  sampling.hausdorff_tolerance = options.tolerance / 100;
  VKMESH_TRY(const SurfaceDistance distance, job.timed("compute", [&] {
    return surface_distance({a.points, a.corners}, {b.points, b.corners}, sampling,
                            job.progress("comparing"));
  }));
  const DistanceSummary both = distance.two_sided();
  Json& result = job.json()["result"];
  result["first"] = {{"points", first.points.size()}, {"faces", first.face_count()}};
  result["second"] = {{"points", second.points.size()}, {"faces", second.face_count()}};
  result["samples"] = options.samples;
  result["diagonal"] = distance.diagonal;
  result["two_sided"] = to_json(both);
  result["first_to_second"] = to_json(distance.a_to_b);
  result["second_to_first"] = to_json(distance.b_to_a);

  const auto with_share = [&](double d) {
    return brief(d) + " (" + brief(100 * d / distance.diagonal) + " % of the diagonal)";
  };
  job.row("mean", with_share(both.mean));
  job.row("root mean square", with_share(both.root_mean_square));
  job.row("Hausdorff", options.tolerance > 0 ? "between " + with_share(both.hausdorff_low) + " and " +
                                                   with_share(both.hausdorff_high)
                                             : "at least " + with_share(both.hausdorff_low));
  job.row("normals", "differ by " + brief(both.mean_normal_angle * kDegrees) + " degrees on average, " +
                         brief(both.maximum_normal_angle * kDegrees) + " at most");
  job.row("one way", "first to second: mean " + brief(distance.a_to_b.mean) + ", largest " +
                         brief(distance.a_to_b.maximum) + "; back: mean " + brief(distance.b_to_a.mean) +
                         ", largest " + brief(distance.b_to_a.maximum));
  return {};
}

}  // namespace

void add_compare(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("compare", "Measures how far two surfaces lie from each other");
  command->footer(
      "Samples are spread over each surface by area, and each takes its distance to the other surface; mean "
      "and "
      "root mean\nsquare weigh both directions alike. The Hausdorff distance is the largest there is, not of "
      "the "
      "samples alone: it lies\nbetween the bounds. Polygons are cut into triangles; nothing else is "
      "repaired.\n\n"
      "Example:\n  vkmesh compare data/dragon/dragon_vrip_res2.ply.gz data/dragon/dragon_vrip_res3.ply.gz");
  add_common_options(*command, program.options, true, false);
  const auto options = std::make_shared<CompareOptions>();
  command->add_option("OTHER", options->other, "The second mesh")->type_name("")->required();
  command->add_option("--samples", options->samples, "Points taken on each surface; default 200000")
      ->type_name("N")
      ->check(count_up_to(std::numeric_limits<std::uint32_t>::max()));
  command
      ->add_option("--tolerance", options->tolerance,
                   "How far apart the bounds of the Hausdorff distance may be, in percent of it;\n"
                   "default 1; with 0 it is at least the largest of the samples")
      ->type_name("P")
      ->check(number_between(0, 1000));
  command->callback([&program, options] {
    program.command = "compare";
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
