// vkmesh optimize: edge swaps that make the triangles better.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/mesh/triangulate.h>
#include <vkmesh/optimize/swap_edges.h>
#include <vkmesh/passes/dihedral_angles.h>
#include <vkmesh/passes/swap_rounds.h>

#include "commands.h"
#include "job/channel_numbers.h"
#include "job/channels.h"
#include "job/triangle_angles.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct NamedCost {
  const char* name;
  SwapCost cost;
};
constexpr std::array kCosts = {NamedCost{"max-min-angle", SwapCost::kMinAngle},
                               NamedCost{"aspect-ratio", SwapCost::kAspectRatio},
                               NamedCost{"delaunay", SwapCost::kDelaunay},
                               NamedCost{"valence", SwapCost::kValence},
                               NamedCost{"curvature", SwapCost::kAbsoluteCurvature},
                               NamedCost{"mean-curvature", SwapCost::kMeanCurvature},
                               NamedCost{"squared-curvature", SwapCost::kSquaredMeanCurvature},
                               NamedCost{"dihedral-angle", SwapCost::kDihedralAngle},
                               NamedCost{"normals", SwapCost::kNormalDeviation}};

struct OptimizeOptions {
  std::vector<std::string> criteria;
  std::optional<double> crease_angle, max_dihedral_change, max_deviation, max_relative_deviation, time_limit;
  std::optional<std::size_t> max_swaps;
  bool in_rounds = false;
  std::uint32_t max_rounds = 0;  // 0: as many as it takes
  bool seams = true, material_borders = true;
};

/// What --criterion says: NAME or NAME=WEIGHT; curvature=mean, =squared and =absolute, too.
Result<std::vector<WeightedSwapCost>> costs_of(const std::vector<std::string>& given) {
  std::vector<WeightedSwapCost> costs;
  for (std::string text : given) {
    for (const auto& [kind, name] :
         {std::pair{"curvature=mean", "mean-curvature"}, std::pair{"curvature=squared", "squared-curvature"},
          std::pair{"curvature=absolute", "curvature"}})
      if (text == kind) text = name;
    VKMESH_TRY(const auto named, named_weight("--criterion", text, 1.0));
    const auto found = std::ranges::find(kCosts, named.first, &NamedCost::name);
    if (found == kCosts.end()) {
      std::string names;
      for (const NamedCost& cost : kCosts) names += std::string(names.empty() ? "" : ", ") + cost.name;
      return fail(ErrorCode::kUsage, "--criterion: '" + named.first + "' is none of " + names);
    }
    if (!(named.second > 0 && named.second <= 1e6))
      return fail(ErrorCode::kUsage,
                  "--criterion: the weight of " + named.first + " is above 0, and 1e6 at most");
    costs.push_back({found->cost, named.second});
  }
  if (costs.empty()) costs.emplace_back();
  return costs;
}

/// Edges that stay for what the file says: numbers for corners and faces, empty where nothing is kept.
struct Borders {
  std::vector<std::uint32_t> corners, faces;
};

Borders borders_of(const IndexedFaceSet& mesh, const OptimizeOptions& options) {
  Borders borders;
  if (options.seams && !mesh.corner_channels.empty())
    borders.corners = numbers_of_values(mesh.corner_channels);
  std::vector<Channel> regions;
  for (const Channel& channel : mesh.face_channels)
    if (channel.name == "material" || channel.name == "group" || !channel.labels.empty())
      regions.push_back(channel);
  if (options.material_borders && !regions.empty()) borders.faces = numbers_of_values(regions);
  return borders;
}

/// What either way of swapping comes to.
struct Swapped {
  HalfEdgeMesh mesh;
  std::vector<std::uint32_t> source_corner;
  std::size_t swaps = 0;
};

Result<Swapped> greedily(Job& job, const HalfEdgeMesh& half_edges, const IndexedFaceSet& mesh,
                         const Borders& borders, SwapEdgesOptions swaps) {
  swaps.corner_groups = borders.corners;
  swaps.face_groups = borders.faces;
  std::vector<Vec3> normals;
  if (std::ranges::any_of(swaps.costs, [](const auto& c) { return c.cost == SwapCost::kNormalDeviation; })) {
    const Channel* given = find_channel(mesh.point_channels, "normal");
    if (given == nullptr || given->components != 3)
      return fail(ErrorCode::kUnsuitable,
                  "--criterion normals compares with normals of points, and the file has none",
                  {job.options().input, {}, {}});
    std::visit(
        [&](const auto& v) {
          for (std::size_t i = 0; i + 2 < v.size(); i += 3)
            normals.emplace_back(static_cast<float>(v[i]), static_cast<float>(v[i + 1]),
                                 static_cast<float>(v[i + 2]));
        },
        given->values);
    swaps.normals = normals;
  }
  VKMESH_TRY(SwappedEdges done, job.timed("compute", [&] {
    return swap_edges(half_edges, mesh.points, swaps, job.progress("swapping"));
  }));
  Json blocked;
  std::string held;
  for (std::size_t i = 1; i < kSwapReasons; ++i) {
    std::string name = name_of(static_cast<SwapReason>(i));
    if (done.blocked[i] > 0) held += (held.empty() ? "" : ", ") + name + " " + grouped(done.blocked[i]);
    std::ranges::replace(name, ' ', '_');
    std::ranges::replace(name, '-', '_');
    blocked[name] = done.blocked[i];
  }
  Json& result = job.json()["result"];
  result["cost_before"] = done.cost_before;
  result["cost_after"] = done.cost_after;
  result["stop"] = name_of(done.stop);
  result["held"] = blocked;
  const double drop = done.cost_before > 0 ? 100 * (1 - done.cost_after / done.cost_before) : 0;
  job.row("swapped", count_of(done.swaps, "edge") + "; the cost went from " + brief(done.cost_before) +
                         " to " + brief(done.cost_after) + (drop > 0 ? ", " + brief(drop) + " % less" : ""));
  job.row("stopped", done.stop == SwapStop::kNoGain ? "no legal swap makes it better"
                                                    : "by the " + name_of(done.stop) + " that was given");
  if (!held.empty()) job.row("held", "swaps that would be better still: " + held);
  return Swapped{std::move(done.mesh), std::move(done.source_corner), done.swaps};
}

Result<Swapped> in_rounds(Job& job, Backend& backend, const HalfEdgeMesh& half_edges,
                          const IndexedFaceSet& mesh, const Borders& borders, const OptimizeOptions& options,
                          SwapCriterion criterion) {
  std::vector<std::uint32_t> locked(half_edges.half_edge_count(), 0);
  DihedralAngles angles;
  if (options.crease_angle) {
    VKMESH_TRY(angles, backend.run(dihedral_angles_pass(), {half_edges, mesh.points}));
  }
  for (std::uint32_t h = 0; h < locked.size(); ++h) {
    const std::uint32_t t = half_edges.twins()[h];
    if (t == kInvalid) continue;
    const auto next = [&](std::uint32_t e) { return half_edges.next(HalfEdgeId(e)).index; };
    const auto& c = borders.corners;
    const bool seam = !c.empty() && (c[h] != c[next(t)] || c[next(h)] != c[t]);
    const bool border = !borders.faces.empty() && borders.faces[h / 3] != borders.faces[t / 3];
    const bool crease =
        options.crease_angle &&
        std::fabs(static_cast<double>(angles.half_edge[h])) * kDegrees >= *options.crease_angle;
    locked[h] = seam || border || crease ? 1 : 0;
  }
  SwapRoundsOptions rounds;
  rounds.criterion = criterion;
  rounds.locked = locked;
  if (options.max_rounds > 0) rounds.max_rounds = options.max_rounds;
  VKMESH_TRY(SwapRounds done, backend.swap_rounds(half_edges, mesh.points, rounds));
  std::size_t swaps = 0;
  for (const std::uint32_t n : done.swaps) swaps += n;
  const bool ended = done.swaps.empty() || done.swaps.back() == 0;
  const std::size_t count =
      done.swaps.size() - (ended && !done.swaps.empty() ? 1 : 0);  // but the last, of none
  job.json()["result"]["rounds"] = count;
  job.json()["result"]["swaps_of_rounds"] = done.swaps;
  job.json()["result"]["stop"] = ended ? "no gain" : "number of rounds";
  job.row("swapped", count_of(swaps, "edge") + " in " + count_of(count, "round"));
  job.row("stopped", ended ? "no legal swap makes it better" : "by the number of rounds that was given");
  return Swapped{std::move(done.mesh), std::move(done.source_corner), swaps};
}

Result<void> run(Job& job, const OptimizeOptions& options) {
  SwapEdgesOptions swaps;
  VKMESH_TRY(swaps.costs, costs_of(options.criteria));
  const bool by_angle = swaps.costs.size() == 1 && swaps.costs[0].cost == SwapCost::kMinAngle,
             by_quality = swaps.costs.size() == 1 && swaps.costs[0].cost == SwapCost::kAspectRatio;
  if (options.in_rounds && !by_angle && !by_quality)
    return fail(ErrorCode::kUsage, "--rounds goes with --criterion max-min-angle or aspect-ratio alone");
  if (options.crease_angle) swaps.crease_angle = *options.crease_angle / kDegrees;
  if (options.max_dihedral_change) swaps.max_dihedral_change = *options.max_dihedral_change / kDegrees;
  if (options.max_deviation) swaps.max_deviation = Length::absolute(*options.max_deviation);
  if (options.max_relative_deviation) swaps.max_deviation = Length::relative(*options.max_relative_deviation);
  swaps.max_swaps = options.max_swaps;
  swaps.seconds = options.time_limit;
  VKMESH_CHECK(job.check_output());
  std::optional<Backend> backend;
  if (options.in_rounds) {
    VKMESH_TRY(Backend opened, open_backend(job));
    backend.emplace(std::move(opened));
  } else {
    use_host(job);
  }
  VKMESH_TRY(IndexedFaceSet mesh, job.read());
  if (mesh.face_count() == 0)
    return fail(ErrorCode::kUnsuitable, "a point cloud has no edges to swap", {job.options().input, {}, {}});
  VKMESH_TRY(const HalfEdgeMesh half_edges, job.consolidate_triangles(mesh));
  if (!mesh.is_triangles()) {
    job.note("polygons were cut into triangles");
    VKMESH_TRY(Triangulated cut, triangulate(mesh));  // as the half-edges were
    mesh = std::move(cut.mesh);
  }
  VKMESH_CHECK(drop_normals(job, {&mesh.corner_channels, &mesh.face_channels}));
  const Borders borders = borders_of(mesh, options);
  std::string names;
  for (const WeightedSwapCost& cost : swaps.costs)
    names += (names.empty() ? "" : ", ") +
             std::string(std::ranges::find(kCosts, cost.cost, &NamedCost::cost)->name);
  job.json()["result"] = {{"criterion", names}};
  VKMESH_TRY(const TriangleAngles before, triangle_angles(half_edges, mesh.points));
  VKMESH_TRY(Swapped swapped,
             options.in_rounds ? in_rounds(job, *backend, half_edges, mesh, borders, options,
                                           by_angle ? SwapCriterion::kMinAngle : SwapCriterion::kAspectRatio)
                               : greedily(job, half_edges, mesh, borders, std::move(swaps)));
  VKMESH_TRY(const TriangleAngles after, triangle_angles(swapped.mesh, mesh.points));
  mesh.corners.assign(swapped.mesh.origins().begin(), swapped.mesh.origins().end());
  mesh.corner_channels = gather(mesh.corner_channels, swapped.source_corner);
  Json& result = job.json()["result"];
  result["swaps"] = swapped.swaps;
  result["angles_before"] = json_of(before);
  result["angles_after"] = json_of(after);
  job.row("angles before", text_of(before, mesh.face_count()));
  job.row("angles after", text_of(after, mesh.face_count()));
  return job.write(mesh);
}

}  // namespace

void add_optimize(CLI::App& app, Program& program) {
  CLI::App* command =
      app.add_subcommand("optimize", "Swaps edges, so that triangles are better; points stay");
  command->footer(
      "The edge whose swap makes things best is swapped, again and again, until no legal swap makes anything "
      "better.\n"
      "Boundary, texture seams and borders between materials stay. Runs on the host, --rounds on any "
      "device.\n\n"
      "Criteria:\n"
      "  max-min-angle      the smaller of the least angles of the two triangles grows (the default)\n"
      "  aspect-ratio       the worse of the two triangles gets nearer to an equilateral one\n"
      "  delaunay           the sum of all cotangents falls: in the plane, circles get empty\n"
      "  valence            points get nearer to six neighbours, four on the boundary\n"
      "  curvature          the sum of the absolute principal curvatures falls; edges follow the shape\n"
      "  mean-curvature, squared-curvature    the same by |H|, and by H^2\n"
      "  dihedral-angle     the sum of the angles between neighbouring triangles falls\n"
      "  normals            triangles get nearer to the normals that the file has for its points\n\n"
      "Examples:\n"
      "  vkmesh optimize data/cgal/meshes/elephant.off better.ply\n"
      "  vkmesh optimize data/cgal/meshes/elephant.off round.ply --criterion curvature "
      "--max-relative-deviation 1e-3\n"
      "  vkmesh optimize data/cgal/meshes/fandisk.off even.off --criterion valence --criterion "
      "max-min-angle=2 "
      "--keep-creases 30\n"
      "  vkmesh optimize data/cgal/meshes/elephant.off better.ply --rounds --device llvmpipe");
  add_common_options(*command, program.options, true, true);
  add_consolidate_options(*command, program.options);
  add_keep_splits(*command, program.options);
  const auto options = std::make_shared<OptimizeOptions>();
  command
      ->add_option(
          "--criterion", options->criteria,
          "What a swap makes better, see below; default max-min-angle. More than one may be given: their\n"
          "weighted sum falls then, lengths in about that of an edge; default weight 1")
      ->type_name("NAME[=WEIGHT]");
  command
      ->add_option("--keep-creases", options->crease_angle,
                   "Edges bent by at least so many degrees stay; default none")
      ->type_name("DEG")
      ->check(number_between(0.001, 180));
  CLI::Option* dihedral =
      command
          ->add_option("--max-dihedral-change", options->max_dihedral_change,
                       "Swap no edge whose bend and that of the new one differ by more degrees")
          ->type_name("DEG")
          ->check(number_between(0.001, 180));
  CLI::Option* deviation =
      command
          ->add_option("--max-deviation", options->max_deviation,
                       "Swap no edge that is farther from the new one than this, in units of the file")
          ->type_name("D")
          ->check(number_between(0, std::numeric_limits<double>::max()));
  CLI::Option* relative = command
                              ->add_option("--max-relative-deviation", options->max_relative_deviation,
                                           "The same as a share of the bounding box's diagonal")
                              ->type_name("D")
                              ->check(number_between(0, std::numeric_limits<double>::max()))
                              ->excludes(deviation);
  CLI::Option* most = command->add_option("--max-swaps", options->max_swaps, "Stop after this many swaps")
                          ->check(count_up_to(std::numeric_limits<std::uint32_t>::max()))
                          ->type_name("N");
  CLI::Option* time =
      command->add_option("--time-limit", options->time_limit, "Stop after this many seconds of swapping")
          ->type_name("S")
          ->check(number_between(0, std::numeric_limits<double>::max()));
  command->add_flag("!--no-seams", options->seams,
                    "Let edges of texture seams swap; their corners keep one side's values");
  command->add_flag("!--no-material-borders", options->material_borders,
                    "Let edges between materials or groups swap");
  CLI::Option* rounds =
      command
          ->add_option(
              "--rounds", options->max_rounds,
              "Swap in rounds, many edges at once that do not touch, on the device of --device; at most\n"
              "this many rounds, without a number as many as it takes. max-min-angle and aspect-ratio only")
          ->type_name("[N]")
          ->expected(0, 1)
          ->check(count_up_to(std::numeric_limits<std::uint32_t>::max() - 1));
  command->callback(
      [&program, options, rounds, of_greedy = std::vector{dihedral, deviation, relative, most, time}] {
        options->in_rounds = rounds->count() > 0;
        for (const CLI::Option* option : of_greedy)
          if (options->in_rounds && option->count() > 0)
            throw CLI::ValidationError(option->get_name(), "does not go with --rounds");
        program.command = "optimize";
        program.action = [options](Job& job) { return run(job, *options); };
      });
}

}  // namespace vkmesh::cli
