// vkmesh smooth: Taubin, Laplacian and bilateral smoothing.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "commands.h"
#include "job/channels.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct SmoothOptions {
  std::string method = "taubin";
  LaplacianSmoothingOptions steps;
  std::optional<float> mu;
  std::string boundary = "fixed";
  double spatial = 4, influence = 1;  // Mean edge lengths.
  std::optional<bool> keep_volume;

  /// Unless told: bilateral smoothing alone moves curved surfaces outward. An open surface has no volume.
  [[nodiscard]] bool keeps_volume(const HalfEdgeMesh& mesh) const {
    return keep_volume.value_or(method == "bilateral" && mesh.face_count() > 0 &&
                                mesh.boundary_half_edge_count() == 0);
  }
};

struct Smoothed {
  std::vector<Vec3> points;
  std::string how;  // For the table.
};

/// A little beyond -lambda: with it the pass band ends at 1/lambda + 1/mu = 0.1.
float default_mu(float lambda) {
  return -std::min(1.0f, lambda / (1.0f - 0.1f * lambda));
}

/// Refuses a pair that makes noise grow instead of smoothing it, and notes what else grows.
Result<void> check_gain(Job& job, const LaplacianSmoothingOptions& steps) {
  if (steps.mu == 0.0f) return {};
  constexpr double kHighest = 2, kTooMuch = 2, kMuch = 1.1;
  const auto lambda = static_cast<double>(steps.lambda), mu = static_cast<double>(steps.mu);
  const auto growth = [&](double k) {
    return std::pow(std::fabs(smoothing_gain(lambda, mu, k)), steps.iterations);
  };
  if (growth(kHighest) > kTooMuch)
    return fail(ErrorCode::kUsage,
                "--lambda " + brief(lambda) + " with --mu " + brief(mu) +
                    " makes the finest detail grow, by up to " +
                    brief(std::fabs(smoothing_gain(lambda, mu, kHighest))) +
                    " in each iteration: 1/lambda + 1/mu may be 2 at most, and lambda with this mu " +
                    brief((1 - mu) / (1 - 2 * mu)));
  // The gain is largest in the middle of the pass band.
  const double middle = lambda > 0 ? std::clamp((1 / lambda + 1 / mu) / 2, 0.0, kHighest) : kHighest;
  if (const double most = std::max(growth(kHighest), growth(middle)); most > kMuch)
    job.note("so many iterations of lambda " + brief(lambda) + " and mu " + brief(mu) +
             " make waves of the surface grow, by up to " + brief(most) +
             "; fewer, or a --mu nearer to -lambda, make that less");
  return {};
}

Result<Smoothed> by_steps(Job& job, Backend& backend, const HalfEdgeMesh& mesh, std::span<const Vec3> points,
                          const SmoothOptions& options) {
  LaplacianSmoothingOptions steps = options.steps;
  steps.boundary = options.boundary == "fixed"   ? SmoothingBoundary::kFixed
                   : options.boundary == "along" ? SmoothingBoundary::kAlongItself
                                                 : SmoothingBoundary::kFree;
  job.json()["result"] = {{"method", options.method},
                          {"lambda", steps.lambda},
                          {"mu", steps.mu},
                          {"iterations", steps.iterations},
                          {"weights", steps.weights == SmoothingWeights::kUniform ? "uniform" : "cotangent"},
                          {"boundary", options.boundary}};
  VKMESH_TRY(std::vector<Vec3> smoothed,
             backend.run(laplacian_smoothing_pass(steps, options.keeps_volume(mesh)), {mesh, points}));
  return Smoothed{std::move(smoothed),
                  count_of(steps.iterations, "step") + " with lambda " +
                      brief(static_cast<double>(steps.lambda)) +
                      (steps.mu < 0 ? " and mu " + brief(static_cast<double>(steps.mu)) : "")};
}

Result<Smoothed> by_predictions(Job& job, Backend& backend, const HalfEdgeMesh& mesh,
                                std::span<const Vec3> points, const SmoothOptions& options) {
  const double edge = mean_edge_length(mesh, points);
  const BilateralSmoothingOptions widths{.spatial = static_cast<float>(options.spatial * edge),
                                         .influence = static_cast<float>(options.influence * edge)};
  job.json()["result"] = {{"method", options.method},
                          {"spatial", options.spatial},
                          {"influence", options.influence},
                          {"mean_edge_length", edge}};
  if (mesh.face_count() == 0) return Smoothed{{points.begin(), points.end()}, "nothing: there are no faces"};
  VKMESH_TRY(std::vector<Vec3> smoothed,
             backend.run(bilateral_smoothing_pass(widths, options.keeps_volume(mesh)), {mesh, points}));
  return Smoothed{std::move(smoothed), "within " + brief(options.spatial) + ", across " +
                                           brief(options.influence) + " mean edge lengths of " + brief(edge)};
}

Result<void> run(Job& job, const SmoothOptions& options) {
  VKMESH_CHECK(check_gain(job, options.steps));
  VKMESH_CHECK(job.check_output());
  VKMESH_TRY(Backend backend, open_backend(job));
  VKMESH_TRY(IndexedFaceSet mesh, job.read());
  VKMESH_TRY(const HalfEdgeMesh half_edges, job.consolidate_triangles(mesh));
  const auto smooth = options.method == "bilateral" ? by_predictions : by_steps;
  VKMESH_TRY(Smoothed smoothed, smooth(job, backend, half_edges, mesh.points, options));

  double sum = 0, largest = 0;
  for (std::size_t i = 0; i < smoothed.points.size(); ++i) {
    const DVec3 d = DVec3(smoothed.points[i]) - DVec3(mesh.points[i]);
    const double length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    sum += length;
    largest = std::max(largest, length);
  }
  const double mean = smoothed.points.empty() ? 0 : sum / static_cast<double>(smoothed.points.size());
  mesh.points = std::move(smoothed.points);
  Json& result = job.json()["result"];
  result["keep_volume"] = options.keeps_volume(half_edges);
  result["mean_move"] = mean;
  result["largest_move"] = largest;
  job.row("smoothed", options.method + ", " + smoothed.how + "; points moved by " + brief(mean) +
                          " on average, " + brief(largest) + " at most");

  // Normals of the surface as it was would shade the new one wrongly.
  VKMESH_CHECK(drop_normals(job, {&mesh.point_channels, &mesh.corner_channels, &mesh.face_channels}));
  return job.write(mesh);
}

}  // namespace

void add_smooth(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("smooth", "Smooths: Taubin, Laplacian or bilateral");
  command->footer(
      "taubin (the default): each iteration moves every point by lambda of the way to the mean of its "
      "neighbours, then\nby mu of the way back, so that the surface does not shrink. laplacian: the first "
      "step only. bilateral: every\npoint moves once, to where the faces around it predict it; noise goes, "
      "edges stay. Narrow and narrow (2 and 0.2)\nremoves noise, narrow and wide (2 and 4) small features, "
      "wide and wide (4 and 4) large ones. By itself it moves\ncurved surfaces outward (a sphere whose edges "
      "are 0.15 of its radius by 8 %), so that it keeps the volume of what\nis closed. Polygons stay; their "
      "points have the neighbours of the triangles they are cut into. Every device gives\nthe same bytes.\n\n"
      "Examples:\n  vkmesh smooth data/dragon/dragon_vrip.ply.gz smooth.ply --iterations 20\n"
      "  vkmesh smooth data/cgal/meshes/fandisk.off smooth.ply --method bilateral --spatial 2 --influence "
      "0.2");
  add_common_options(*command, program.options, true, true);
  add_consolidate_options(*command, program.options);
  add_keep_splits(*command, program.options);
  const auto options = std::make_shared<SmoothOptions>();
  command->add_option("--method", options->method, "taubin (default), laplacian or bilateral")
      ->type_name("METHOD")
      ->check(CLI::IsMember({"taubin", "laplacian", "bilateral"}).description(""));
  CLI::Option* lambda =
      command
          ->add_option("--lambda", options->steps.lambda,
                       "Share of the way in each step, from 0 to 1; default 0.5. With taubin about\n"
                       "0.7 at most: beyond, the finest detail grows, which is refused")
          ->type_name("L")
          ->check(number_between(0, 1));
  CLI::Option* iterations = command
                                ->add_option("--iterations", options->steps.iterations,
                                             "Number of iterations, from 0 to 1000000; default 10")
                                ->type_name("N")
                                ->check(count_up_to(1000000));
  CLI::Option* mu = command
                        ->add_option("--mu", options->mu,
                                     "Taubin's step back, from -1 to 0; default a little beyond -lambda:\n"
                                     "-lambda / (1 - 0.1 lambda)")
                        ->type_name("M")
                        ->check(number_between(-1, 0));
  const std::map<std::string, SmoothingWeights> kinds = {{"uniform", SmoothingWeights::kUniform},
                                                         {"cotangent", SmoothingWeights::kCotangent}};
  CLI::Option* weights =
      command
          ->add_option("--weights", options->steps.weights,
                       "How much each neighbour counts: uniform (default), or cotangent, which moves points\n"
                       "along the normal and keeps the shapes of triangles")
          ->type_name("uniform|cotangent")
          ->transform(one_of(kinds));
  CLI::Option* boundary =
      command
          ->add_option("--boundary", options->boundary,
                       "What points on the boundary do: fixed (default), along (they move along the "
                       "boundary), free")
          ->type_name("HOW")
          ->check(CLI::IsMember({"fixed", "along", "free"}).description(""));
  CLI::Option* spatial =
      command
          ->add_option("--spatial", options->spatial,
                       "Bilateral: how far faces count, sigma_f in mean edge lengths; default 4")
          ->type_name("F")
          ->check(number_between(0.01, 1e6));
  CLI::Option* influence =
      command
          ->add_option("--influence", options->influence,
                       "Bilateral: how far off its place a point may be predicted, sigma_g in mean edge\n"
                       "lengths; default 1")
          ->type_name("G")
          ->check(number_between(0.001, 1e6));
  command->add_flag_function(
      "--keep-volume,!--no-keep-volume", [options](std::int64_t count) { options->keep_volume = count > 0; },
      "Scale the smoothed surface about its centroid to the volume that it had; it must be\n"
      "closed. Bilateral does so where the surface is, unless --no-keep-volume is given");
  command->callback([&program, options, of_steps = std::vector{lambda, iterations, weights, boundary},
                     of_predictions = std::vector{spatial, influence}, mu] {
    const auto refuse = [&](const CLI::Option* option) {
      if (option->count() > 0)
        throw CLI::ValidationError(option->get_name(), "does not go with --method " + options->method);
    };
    if (options->method != "taubin") refuse(mu);
    for (const CLI::Option* option : options->method == "bilateral" ? of_steps : of_predictions)
      refuse(option);
    if (options->method == "taubin")
      options->steps.mu = options->mu.value_or(default_mu(options->steps.lambda));
    program.command = "smooth";
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
