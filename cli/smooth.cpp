// vkmesh smooth: Laplacian smoothing.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>

#include "backend.h"
#include "commands.h"

namespace vkmesh::cli {
namespace {

Result<void> run(Job& job, const LaplacianSmoothingOptions& options) {
  VKMESH_CHECK(job.check_output());
  VKMESH_TRY(const std::unique_ptr<Backend> backend, open_backend(job));
  VKMESH_TRY(IndexedFaceSet mesh, job.read());
  VKMESH_TRY(const HalfEdgeMesh half_edges, job.consolidate_triangles(mesh));
  VKMESH_TRY(std::vector<Vec3> smoothed, backend->laplacian_smoothing(half_edges, mesh.points, options));

  double sum = 0, largest = 0;
  for (std::size_t i = 0; i < smoothed.size(); ++i) {
    const DVec3 d = DVec3(smoothed[i]) - DVec3(mesh.points[i]);
    const double length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    sum += length;
    largest = std::max(largest, length);
  }
  const double mean = smoothed.empty() ? 0 : sum / static_cast<double>(smoothed.size());
  mesh.points = std::move(smoothed);
  job.json()["result"] = {
      {"lambda", options.lambda},
      {"mu", options.mu},
      {"iterations", options.iterations},
      {"weights", options.weights == SmoothingWeights::kUniform ? "uniform" : "cotangent"},
      {"boundary", options.fix_boundary            ? "fixed"
                   : options.boundary_along_itself ? "along"
                                                   : "free"},
      {"mean_move", mean},
      {"largest_move", largest}};
  job.row("smoothed", count_of(options.iterations, "step") + " with lambda " +
                          brief(static_cast<double>(options.lambda)) +
                          (options.mu < 0 ? " and mu " + brief(static_cast<double>(options.mu)) : "") +
                          "; points moved by " + brief(mean) + " on average, " + brief(largest) + " at most");

  // Normals of the surface as it was would shade the new one wrongly.
  for (auto* channels : {&mesh.point_channels, &mesh.corner_channels, &mesh.face_channels})
    if (std::erase_if(*channels, [](const Channel& c) { return c.name == "normal"; }) > 0)
      job.note(
          "the input's normals do not fit the moved points and were left out; vkmesh normals makes new ones");
  return job.write(mesh);
}

}  // namespace

void add_smooth(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("smooth", "Smooths by Laplacian steps");
  command->footer(
      "Each step moves every point by lambda of the way to the mean of its neighbours, all points at once. "
      "Polygons "
      "stay; their\npoints have the neighbours of the triangles they are cut into. Every device gives the "
      "same bytes.\n\n"
      "Example:\n  vkmesh smooth data/dragon/dragon_vrip.ply.gz smooth.ply --lambda 0.5 --iterations "
      "10");
  add_common_options(*command, program.options, true, true);
  add_consolidate_options(*command, program.options);
  const auto options = std::make_shared<LaplacianSmoothingOptions>();
  command->add_option("--lambda", options->lambda, "Share of the way in each step, from 0 to 1; default 0.5")
      ->type_name("L")
      ->check(number_between(0, 1));
  command->add_option("--iterations", options->iterations, "Number of steps, from 0 to 1000000; default 10")
      ->type_name("N")
      ->check(count_up_to(1000000));
  command
      ->add_option(
          "--mu", options->mu,
          "A second step of each iteration, backwards, from -1 to 0; a little beyond -lambda, such as\n"
          "-0.53, the surface does not shrink (Taubin); default 0, none")
      ->type_name("M")
      ->check(number_between(-1, 0));
  const std::map<std::string, SmoothingWeights> weights = {{"uniform", SmoothingWeights::kUniform},
                                                           {"cotangent", SmoothingWeights::kCotangent}};
  command
      ->add_option("--weights", options->weights,
                   "How much each neighbour counts: uniform (default), or cotangent, which moves points\n"
                   "along the normal and keeps the shapes of triangles")
      ->type_name("uniform|cotangent")
      ->transform(CLI::CheckedTransformer(weights).description(""));
  command
      ->add_option_function<std::string>(
          "--boundary",
          [options](const std::string& how) {
            options->fix_boundary = how == "fixed";
            options->boundary_along_itself = how == "along";
          },
          "What points on the boundary do: fixed (default), along (they move along the boundary), free")
      ->type_name("HOW")
      ->check(CLI::IsMember({"fixed", "along", "free"}).description(""));
  command->callback([&program, options] {
    program.command = "smooth";
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
