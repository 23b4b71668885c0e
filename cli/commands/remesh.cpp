// vkmesh remesh: even triangles on the same surface.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <vkmesh/mesh/triangulate.h>
#include <vkmesh/remesh/remesh.h>

#include "commands.h"
#include "job/channels.h"
#include "job/triangle_angles.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct RemeshChoice {
  std::optional<double> edge_length, relative_edge_length, adaptive, relative_adaptive, shortest, longest,
      creases, tolerance, max_deviation, max_relative_deviation, time_limit;
  std::optional<std::size_t> faces;
  unsigned iterations = RemeshOptions{}.iterations;
  std::string boundary = "in-shape", lock;
};

RemeshOptions options_of(const RemeshChoice& choice) {
  RemeshOptions options;
  options.size.edge_length = length_of(choice.edge_length, choice.relative_edge_length);
  options.size.faces = choice.faces;
  options.size.deviation = length_of(choice.adaptive, choice.relative_adaptive);
  options.size.shortest = length_of(choice.shortest, {});
  options.size.longest = length_of(choice.longest, {});
  options.curves.boundary_kept = choice.boundary == "kept";
  options.curves.tolerance = length_of(choice.tolerance, {});
  if (choice.creases) {
    const double angle = *choice.creases / kDegrees;
    options.curves.creases = CreaseOptions{.sharp_angle = angle, .soft_angle = angle / 2};
  }
  options.max_deviation = length_of(choice.max_deviation, choice.max_relative_deviation);
  options.iterations = choice.iterations;
  options.seconds = choice.time_limit;
  return options;
}

/// What the elements of the result have in a channel: mixtures of three elements of the input each, or where
/// its values number things that of the nearest.
template <class CornersOf>
Channel mixed(const Channel& channel, std::span<const SurfacePoint> points, CornersOf&& corners_of) {
  const std::size_t n = channel.components;
  const bool mixes = can_be_mixed(channel), is_normal = channel.name == "normal" && n == 3;
  ChannelValues made = std::visit(
      [&](const auto& given) -> ChannelValues {
        std::remove_cvref_t<decltype(given)> values;
        using Scalar = typename std::remove_cvref_t<decltype(given)>::value_type;
        values.reserve(points.size() * n);
        for (const SurfacePoint& point : points) {
          const std::array<std::uint32_t, 3> corners = corners_of(point.face);
          const std::size_t nearest = static_cast<std::size_t>(
              std::max_element(point.weights.begin(), point.weights.end()) - point.weights.begin());
          std::vector<double> sum(n, 0.0);
          for (std::size_t k = 0; k < n; ++k)
            for (std::size_t i = 0; i < 3; ++i)
              sum[k] += static_cast<double>(point.weights[i]) *
                        static_cast<double>(given[std::size_t{corners[i]} * n + k]);
          double scale = 1;
          if (is_normal) {
            const double length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
            if (length > 0) scale = 1 / length;
          }
          for (std::size_t k = 0; k < n; ++k) {
            if (!mixes || point.weights[nearest] == 1.0f)
              values.push_back(given[std::size_t{corners[nearest]} * n + k]);
            else if constexpr (std::is_floating_point_v<Scalar>)
              values.push_back(static_cast<Scalar>(sum[k] * scale));
            else
              values.push_back(static_cast<Scalar>(std::floor(sum[k] + 0.5)));
          }
        }
        return values;
      },
      channel.values);
  return {channel.name, channel.components, std::move(made), channel.labels};
}

/// The attributes of a surface while it is remeshed.
class RemeshAttributes {
 public:
  RemeshAttributes(IndexedFaceSet& mesh, const HalfEdgeMesh& half_edges)
      : points_(std::move(mesh.point_channels)),
        corners_(std::move(mesh.corner_channels)),
        faces_(std::move(mesh.face_channels)),
        corner_points_(half_edges.origins().begin(), half_edges.origins().end()) {
    mesh.point_channels = mesh.corner_channels = mesh.face_channels = {};
    std::vector<bool> is_seam(half_edges.half_edge_count(), false);
    for (const Channel& channel : corners_) find_seams(half_edges, channel, is_seam);
    for (const Channel& channel : faces_) {
      if (has_regions(count_borders(half_edges, channel), channel))
        find_borders(half_edges, channel, is_seam);
    }
    for (std::uint32_t h = 0; h < is_seam.size(); ++h)
      if (is_seam[h]) seams_.push_back(h);
  }

  /// Half-edges on whose sides attributes differ.
  [[nodiscard]] const std::vector<std::uint32_t>& seams() const { return seams_; }

  void give(const Remeshed& remeshed, IndexedFaceSet& output) const {
    const auto points_of = [&](std::uint32_t f) {
      return std::array{corner_points_[3 * std::size_t{f}], corner_points_[3 * std::size_t{f} + 1],
                        corner_points_[3 * std::size_t{f} + 2]};
    };
    const auto corners_of = [](std::uint32_t f) { return std::array{3 * f, 3 * f + 1, 3 * f + 2}; };
    const std::span origins(remeshed.origins);
    for (const Channel& channel : points_)
      output.point_channels.push_back(mixed(channel, origins.first(output.points.size()), points_of));
    for (const Channel& channel : corners_)
      output.corner_channels.push_back(gather(mixed(channel, origins, corners_of), remeshed.corner_origins));
    output.face_channels = gather(faces_, remeshed.source_faces);
  }

  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto* channels : {&points_, &corners_, &faces_})
      for (const Channel& channel : *channels) names.push_back(channel.name);
    return names;
  }

 private:
  static void find_seams(const HalfEdgeMesh& mesh, const Channel& channel, std::vector<bool>& is_seam) {
    const std::size_t n = channel.components;
    std::visit(
        [&](const auto& values) {
          const std::span all(values);
          const auto same = [&](std::uint32_t c, std::uint32_t d) {
            return std::ranges::equal(all.subspan(c * n, n), all.subspan(d * n, n));
          };
          for (std::uint32_t h = 0; h < is_seam.size(); ++h) {
            const HalfEdgeId t = mesh.twin(HalfEdgeId(h));
            if (t.valid() && !(same(h, mesh.next(t).index) && same(mesh.next(HalfEdgeId(h)).index, t.index)))
              is_seam[h] = true;
          }
        },
        channel.values);
  }
  static void find_borders(const HalfEdgeMesh& mesh, const Channel& channel, std::vector<bool>& is_seam) {
    const std::size_t n = channel.components;
    std::visit(
        [&](const auto& values) {
          const std::span all(values);
          for (std::uint32_t h = 0; h < is_seam.size(); ++h)
            if (const std::uint32_t t = mesh.twins()[h]; t != kInvalid)
              is_seam[h] =
                  is_seam[h] || !std::ranges::equal(all.subspan(h / 3 * n, n), all.subspan(t / 3 * n, n));
        },
        channel.values);
  }

  std::vector<Channel> points_, corners_, faces_;
  std::vector<std::uint32_t> corner_points_;  // the point of each corner of the input
  std::vector<std::uint32_t> seams_;
};

Result<void> run(Job& job, const RemeshChoice& choice) {
  use_host(job);
  VKMESH_CHECK(job.check_output());
  VKMESH_TRY(IndexedFaceSet mesh, job.read());
  if (mesh.face_count() == 0)
    return fail(ErrorCode::kUnsuitable, "a point cloud has no faces to remesh",
                {job.options().input, {}, {}});
  VKMESH_TRY(const HalfEdgeMesh half_edges, job.consolidate_triangles(mesh));
  if (!mesh.is_triangles()) {
    job.note("polygons were cut into triangles");
    VKMESH_TRY(Triangulated cut, triangulate(mesh));  // as the half-edges were
    mesh = std::move(cut.mesh);
  }
  RemeshOptions options = options_of(choice);
  Marked marked;
  if (!choice.lock.empty()) {
    VKMESH_TRY(marked, find_marked(mesh, choice.lock));
    for (const std::uint32_t f : marked.faces)
      for (const std::uint32_t v : mesh.face(f)) marked.vertices.push_back(v);
    options.locked = marked.vertices;
  }
  VKMESH_CHECK(drop_normals(job, {&mesh.corner_channels, &mesh.face_channels}));
  const RemeshAttributes attributes(mesh, half_edges);
  options.curves.edges = attributes.seams();
  VKMESH_TRY(Remeshed remeshed, job.timed("compute", [&] {
    return remesh(half_edges, mesh.points, options, job.progress("remeshing"));
  }));

  IndexedFaceSet output;
  output.corners.assign(remeshed.mesh.origins().begin(), remeshed.mesh.origins().end());
  output.points = std::move(remeshed.positions);
  attributes.give(remeshed, output);
  VKMESH_TRY(const TriangleAngles before, triangle_angles(half_edges, mesh.points));
  VKMESH_TRY(const TriangleAngles after, triangle_angles(remeshed.mesh, output.points));
  job.json()["result"] = {{"stop", name_of(remeshed.stop)},
                          {"edge_length", remeshed.edge_length},
                          {"mean_edge_length", mean_edge_length(remeshed.mesh, output.points)},
                          {"iterations", choice.iterations},
                          {"splits", remeshed.splits},
                          {"collapses", remeshed.collapses},
                          {"swaps", remeshed.swaps},
                          {"largest_distance", remeshed.largest_distance},
                          {"angles_before", json_of(before)},
                          {"angles_after", json_of(after)},
                          {"attributes", attributes.names()}};
  job.row("remeshed", "to edges of " + brief(mean_edge_length(remeshed.mesh, output.points)) +
                          " on average; " + brief(remeshed.edge_length) +
                          (choice.adaptive || choice.relative_adaptive ? " at most were" : " was") +
                          " asked for");
  job.row("angles", text_of(after, output.face_count()));
  job.row("before", text_of(before, half_edges.face_count()));
  job.row("edits", count_of(remeshed.splits, "split") + ", " + count_of(remeshed.collapses, "collapse") +
                       ", " + count_of(remeshed.swaps, "swap"));
  if (remeshed.stop == RemeshStop::kTimeLimit) job.row("stopped", "the time was up");
  return job.write(output);
}

}  // namespace

void add_remesh(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("remesh", "Makes even triangles on the same surface");
  command->footer(
      "Edges that are too long are split, those that are too short collapsed, edges are swapped and points "
      "move on the\nsurface, again and again. Without a length edges become as long as they are on average. "
      "Seams of texture coordinates\nand borders of materials are kept as curves, attributes are taken from "
      "the old surface. Runs on the host whatever\n--device says.\n\n"
      "Examples:\n"
      "  vkmesh remesh data/cgal/meshes/elephant.off even.ply\n"
      "  vkmesh remesh data/cgal/meshes/fandisk.off part.ply --edge-length 0.02 --keep-creases 40\n"
      "  vkmesh remesh data/cgal/meshes/elephant.off few.ply --faces 3000\n"
      "  vkmesh remesh data/cgal/meshes/elephant.off fine.ply --relative-adaptive 0.0005");
  add_common_options(*command, program.options, true, true);
  add_consolidate_options(*command, program.options);
  add_keep_splits(*command, program.options);
  const auto choice = std::make_shared<RemeshChoice>();
  constexpr double kMost = std::numeric_limits<double>::max(), kLeast = std::numeric_limits<double>::min();
  std::vector<CLI::Option*> sizes = {
      command
          ->add_option("--edge-length", choice->edge_length,
                       "Length of edges, in units of the file's coordinates; default their mean length")
          ->type_name("L")
          ->check(number_between(kLeast, kMost)),
      command
          ->add_option("--relative-edge-length", choice->relative_edge_length,
                       "The same as a share of the bounding box's diagonal")
          ->type_name("L")
          ->check(number_between(kLeast, kMost)),
      command->add_option("--faces", choice->faces, "So many triangles, to within some percent")
          ->type_name("N")
          ->check(count_between(1, std::numeric_limits<std::uint32_t>::max())),
      command
          ->add_option("--adaptive", choice->adaptive,
                       "Lengths by curvature, such that an arc lies by at most this off its chord, in units\n"
                       "of the file's coordinates")
          ->type_name("E")
          ->check(number_between(kLeast, kMost)),
      command
          ->add_option("--relative-adaptive", choice->relative_adaptive,
                       "The same as a share of the bounding box's diagonal")
          ->type_name("E")
          ->check(number_between(kLeast, kMost))};
  for (CLI::Option* one : sizes)
    for (CLI::Option* other : sizes)
      if (one != other) one->excludes(other);
  CLI::Option* shortest = command
                              ->add_option("--min-edge-length", choice->shortest,
                                           "Bounds lengths by curvature; default twice the E of --adaptive")
                              ->type_name("L")
                              ->check(number_between(kLeast, kMost));
  CLI::Option* longest = command
                             ->add_option("--max-edge-length", choice->longest,
                                          "Bounds lengths by curvature; default 40 times the E of --adaptive")
                             ->type_name("L")
                             ->check(number_between(kLeast, kMost));
  command->add_option("--iterations", choice->iterations, "Number of iterations, up to 1000; default 10")
      ->type_name("N")
      ->check(count_up_to(1000));
  command
      ->add_option("--keep-creases", choice->creases,
                   "Keep edges bent by at least so many degrees as curves, and those of half as many that\n"
                   "carry such on; default none")
      ->type_name("DEG")
      ->check(number_between(0.001, 180));
  command
      ->add_option("--boundary", choice->boundary,
                   "in-shape (default): points of the boundary move along it; kept: it stays as it is")
      ->type_name("NAME")
      ->check(CLI::IsMember({"kept", "in-shape"}).description(""));
  command
      ->add_option("--curve-tolerance", choice->tolerance,
                   "How far boundary, creases and seams may lie from the edges that take their place, in\n"
                   "units of the file's coordinates; default a twentieth of the shortest edges asked for")
      ->type_name("T")
      ->check(number_between(0, kMost));
  CLI::Option* deviation =
      command
          ->add_option(
              "--max-deviation", choice->max_deviation,
              "How far the new surface and the old one may lie from each other, in units of the file's\n"
              "coordinates: where it bends too much for long edges, edges stay short; default any")
          ->type_name("D")
          ->check(number_between(kLeast, kMost));
  command
      ->add_option("--max-relative-deviation", choice->max_relative_deviation,
                   "The same as a share of the bounding box's diagonal")
      ->type_name("D")
      ->check(number_between(kLeast, kMost))
      ->excludes(deviation);
  command
      ->add_option("--lock", choice->lock,
                   "Name of an attribute: points, and corners of faces, where it is not 0 stay in place")
      ->type_name("NAME");
  command->add_option("--time-limit", choice->time_limit, "Begin no step after this many seconds")
      ->type_name("S")
      ->check(number_between(0, kMost));
  command->callback([&program, choice, shortest, longest] {
    if (!choice->adaptive && !choice->relative_adaptive)
      for (const CLI::Option* bound : {shortest, longest})
        if (bound->count() > 0) throw CLI::ValidationError(bound->get_name(), "goes with --adaptive only");
    program.command = "remesh";
    program.action = [choice](Job& job) { return run(job, *choice); };
  });
}

}  // namespace vkmesh::cli
