// vkmesh simplify: fewer triangles, by quadric error.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/mesh/triangulate.h>

#include "commands.h"
#include "commands/simplify/simplify_attributes.h"
#include "commands/simplify/simplify_criteria.h"
#include "job/channels.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

struct SimplifyOptions {
  std::string operation = "edge-collapse";
  std::string boundary = "in-shape";
  std::optional<double> ratio;
  std::optional<std::size_t> faces, vertices;
  std::optional<double> error, relative_error, time_limit, crease_angle, prune_size, prune_relative_size;
  AttributeChoice attributes;
  bool index_only = false, force_target = false;
  double max_normal_deviation = DecimateBounds{}.normal_deviation / kRadians;
};

struct ReasonText {
  Reason reason;
  const char* name;  // in JSON
  const char* text;
};
constexpr ReasonText kReasonTexts[] = {{Reason::kLinkCondition, "link", "the manifold would break"},
                                       {Reason::kFoldOver, "fold_over", "a face would fold over"},
                                       {Reason::kErrorBound, "error", "the error is too large"},
                                       {Reason::kLocked, "locked", "locked"},
                                       {Reason::kBoundary, "boundary", "of the boundary"},
                                       {Reason::kSeam, "seam", "a seam would break"},
                                       {Reason::kCriterion, "criterion", "a bound forbids it"}};
static_assert(std::size(kReasonTexts) == kReasons.size());

/// "12 (a face would fold over), …", the most first.
std::string describe(const CountByReason& counts) {
  std::vector<ReasonText> all(std::begin(kReasonTexts), std::end(kReasonTexts));
  std::ranges::stable_sort(all, std::greater(), [&](const ReasonText& r) { return counts[r.reason]; });
  std::string text;
  for (const ReasonText& r : all)
    if (counts[r.reason] > 0)
      text += (text.empty() ? "" : ", ") + grouped(counts[r.reason]) + " (" + r.text + ")";
  return text.empty() ? "nothing" : text;
}

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

DecimateOptions decimation_of(const SimplifyOptions& options) {
  DecimateOptions decimation;
  if (options.operation == "half-edge-collapse") decimation.operation = DecimateOperation::kHalfEdgeCollapse;
  if (options.operation == "vertex-removal") decimation.operation = DecimateOperation::kVertexRemoval;
  decimation.target = {options.faces, options.vertices, options.ratio, options.time_limit,
                       options.force_target};
  if (options.boundary == "kept") decimation.curves.boundary = DecimateBoundary::kKept;
  if (options.boundary == "free") decimation.curves.boundary = DecimateBoundary::kFree;
  if (options.crease_angle) decimation.curves.crease_angle = *options.crease_angle * kRadians;
  decimation.prune_size = length_of(options.prune_size, options.prune_relative_size);
  return decimation;
}

/// Points that no face uses, which a decimation does not know.
std::vector<std::uint32_t> isolated_points(const HalfEdgeMesh& mesh, std::size_t points) {
  std::vector<bool> used(points);
  for (const std::uint32_t p : mesh.origins()) used[p] = true;
  std::vector<std::uint32_t> found;
  for (std::size_t p = 0; p < points; ++p)
    if (!used[p]) found.push_back(static_cast<std::uint32_t>(p));
  return found;
}

/// The ends of boundary edges that lie where two or more others do: of three sheets that meet in a curve,
/// which consolidation has parted.
std::vector<std::uint32_t> ends_on_shared_curves(const HalfEdgeMesh& mesh, const std::vector<Vec3>& points) {
  using Place = std::array<float, 3>;
  struct Side {
    Place low, high;
    std::uint32_t half_edge;
    [[nodiscard]] bool lies_at(const Side& other) const { return low == other.low && high == other.high; }
  };
  const auto place = [&](VertexId v) {
    return Place{points[v.index].x, points[v.index].y, points[v.index].z};
  };
  std::vector<Side> sides;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    if (!mesh.is_boundary(HalfEdgeId(h))) continue;
    const Place from = place(mesh.origin(HalfEdgeId(h))), to = place(mesh.target(HalfEdgeId(h)));
    sides.push_back({std::min(from, to), std::max(from, to), h});
  }
  std::ranges::sort(sides, {}, [](const Side& s) { return std::tie(s.low, s.high); });
  std::vector<std::uint32_t> ends;
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && sides[last].lies_at(sides[first])) ++last;
    for (std::size_t i = first; i < last && last - first > 2; ++i) {
      ends.push_back(mesh.origin(HalfEdgeId(sides[i].half_edge)).index);
      ends.push_back(mesh.target(HalfEdgeId(sides[i].half_edge)).index);
    }
  }
  std::ranges::sort(ends);
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

/// The vertices of the file, which --index-only keeps as they are, while the surface that they make is
/// connected and mended: each corner goes on naming its vertex.
struct VertexBuffer {
  std::vector<Vec3> points;
  std::vector<Channel> channels;

  static VertexBuffer of(IndexedFaceSet& mesh) {
    set_channel(mesh.corner_channels, {kVertex, 1, mesh.corners, {}});
    return {mesh.points, mesh.point_channels};
  }
  static std::vector<std::uint32_t> take_vertices(IndexedFaceSet& mesh) {
    const auto it = std::ranges::find(mesh.corner_channels, kVertex, &Channel::name);
    std::vector<std::uint32_t> vertices = std::move(std::get<std::vector<std::uint32_t>>(it->values));
    mesh.corner_channels.erase(it);
    return vertices;
  }

 private:
  static inline const std::string kVertex = "vertex of the file";
};

Result<void> run(Job& job, const SimplifyOptions& options, const SimplifyCriteria& criteria) {
  if (!options.ratio && !options.faces && !options.vertices && !options.error && !options.relative_error &&
      !options.time_limit)
    return fail(ErrorCode::kUsage,
                "say when to stop: --ratio, --faces, --vertices, --error, --relative-error or --time-limit");
  const bool points_stay = options.operation != "edge-collapse";
  if (options.index_only && !points_stay)
    return fail(ErrorCode::kUsage,
                "--index-only leaves all points where they are: add --operation half-edge-collapse");
  use_host(job);
  VKMESH_CHECK(job.check_output());
  VKMESH_TRY(IndexedFaceSet mesh, job.read());
  const auto read = std::chrono::steady_clock::now();
  if (mesh.face_count() == 0)
    return fail(ErrorCode::kUnsuitable, "a point cloud has no faces to simplify",
                {job.options().input, {}, {}});
  VertexBuffer buffer;
  if (options.index_only) buffer = VertexBuffer::of(mesh);
  VKMESH_TRY(HalfEdgeMesh half_edges, job.consolidate_triangles(mesh));
  if (!mesh.is_triangles()) {
    job.note("polygons were cut into triangles");
    VKMESH_TRY(Triangulated cut, triangulate(mesh));  // as the half-edges were
    mesh = std::move(cut.mesh);
  }
  const std::vector<std::uint32_t> vertex_of_corner =
      options.index_only ? VertexBuffer::take_vertices(mesh) : std::vector<std::uint32_t>();
  DecimateOptions decimation = decimation_of(options);
  VKMESH_TRY(decimation.weights, criteria.weights());
  decimation.bounds = criteria.bounds();
  decimation.bounds.error = length_of(options.error, options.relative_error);
  decimation.bounds.normal_deviation = options.max_normal_deviation * kRadians;
  if (!options.attributes.lock.empty()) {
    VKMESH_TRY(Marked marked, find_marked(mesh, options.attributes.lock));
    decimation.locked.vertices = std::move(marked.vertices);
    decimation.locked.faces = std::move(marked.faces);
  }
  if (const auto ends = ends_on_shared_curves(half_edges, mesh.points); !ends.empty()) {
    job.note(count_of(ends.size(), "point") +
             " on curves where three sheets or more meet stay in place, or gaps would open between them");
    decimation.locked.vertices.insert(decimation.locked.vertices.end(), ends.begin(), ends.end());
  }
  VKMESH_TRY(SimplifyAttributes attributes,
             SimplifyAttributes::of(job, mesh, half_edges, options.attributes, points_stay));
  attributes.tell_apart(vertex_of_corner);
  attributes.add_to(decimation);
  // The half-edges hold the corners from here on; what is let go now keeps the peak of memory low.
  std::vector<Vec3> points = std::move(mesh.points);
  mesh = {};

  const std::size_t faces = half_edges.face_count();
  const std::vector<std::uint32_t> isolated = isolated_points(half_edges, points.size());
  if (options.time_limit) {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - read;
    decimation.target.seconds = std::max(0.0, *options.time_limit - passed.count());
  }
  VKMESH_TRY(Decimated decimated, job.timed("compute", [&] {
    return decimate(half_edges, points, decimation, job.progress("simplifying"));
  }));
  half_edges = {};

  IndexedFaceSet output;
  output.corners.assign(decimated.mesh.origins().begin(), decimated.mesh.origins().end());
  if (options.index_only) {
    for (std::size_t c = 0; c < output.corners.size(); ++c)
      output.corners[c] =
          vertex_of_corner[decimated.attributes.source_corner[decimated.attributes.corners[c]]];
    output.points = std::move(buffer.points);
    output.point_channels = std::move(buffer.channels);
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
  const auto criteria = std::make_shared<SimplifyCriteria>();
  command
      ->add_option("--operation", options->operation,
                   "edge-collapse (default): both ends become one point, which may be new;\n"
                   "half-edge-collapse: one end moves to the other, no new points are made;\n"
                   "vertex-removal: a point goes, and the best triangles fill the hole")
      ->type_name("NAME")
      ->check(CLI::IsMember({"edge-collapse", "half-edge-collapse", "vertex-removal"}));
  command
      ->add_option("--boundary", options->boundary,
                   "kept: boundary points stay; in-shape (default): the boundary's shape counts in\n"
                   "the error; free: it may shrink")
      ->type_name("NAME")
      ->check(CLI::IsMember({"kept", "in-shape", "free"}));
  command
      ->add_option(
          "--attribute", options->attributes.weights,
          "What an attribute of points or corners counts in the error. At weight 1 a change over its\n"
          "whole range counts as a move by the diagonal of the bounding box; default 0.01. More than\n"
          "one may be given; all: each. Without being named, all count but normals (those of points\n"
          "are made to fit) and what numbers things; seams stay closed. A weight of 0: what points\n"
          "have is made to fit, what corners have is left out, and its seams with it")
      ->type_name("NAME[=WEIGHT]");
  command
      ->add_option("--drop-attribute", options->attributes.dropped,
                   "Leave an attribute of this name out, and its seams with it; more than one may be given")
      ->type_name("NAME");
  command->add_flag("!--no-material-borders", options->attributes.material_borders,
                    "Let borders between materials (or other values of faces) go; else they are seams");
  command->add_flag("--index-only", options->index_only,
                    "Keep all points of the file as they are and where they are in it, and write fewer\n"
                    "triangles over them: for half-edge collapses and vertex removal");
  command
      ->add_option("--crease-angle", options->crease_angle,
                   "Edges bent by at least so many degrees are creases, whose shape counts in the error\n"
                   "as that of the boundary does; default none")
      ->type_name("DEG")
      ->check(number_between(0.001, 180));
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
  command->add_flag("--force-target", options->force_target,
                    "Go on to a target that what is locked, kept or on seams puts out of reach, whatever\n"
                    "becomes of the rest; else an eighth of the asked share is left of what may go");
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
  command
      ->add_option("--max-normal-deviation", options->max_normal_deviation,
                   "Do no collapse that turns a remaining face by more than this, in degrees;\n"
                   "from 0.001 to 179.999, default 75")
      ->type_name("DEG")
      ->check(number_between(0.001, 179.999));
  command
      ->add_option("--lock", options->attributes.lock,
                   "Name of an attribute: points and faces where it is not 0 stay as they are")
      ->type_name("NAME");
  CLI::Option* prune =
      command
          ->add_option("--prune-size", options->prune_size,
                       "First take away components whose bounding box has a diagonal of at most this, in\n"
                       "units of the file's coordinates; that of most triangles always stays")
          ->type_name("SIZE")
          ->check(number_between(0, std::numeric_limits<double>::max()));
  command
      ->add_option("--prune-relative-size", options->prune_relative_size,
                   "The same as a share of the whole mesh's diagonal")
      ->type_name("SIZE")
      ->check(number_between(0, std::numeric_limits<double>::max()))
      ->excludes(prune);
  add_simplify_criteria(*command, criteria);
  command->callback([&program, options, criteria] {
    program.command = "simplify";
    program.action = [options, criteria](Job& job) { return run(job, *options, *criteria); };
  });
}

}  // namespace vkmesh::cli
