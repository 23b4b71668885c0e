#include "commands/simplify/decimation_input.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <string_view>
#include <tuple>
#include <utility>

#include <vkmesh/mesh/triangulate.h>

#include "job/channels.h"

namespace vkmesh::cli {
namespace {

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

/// The channel of corners that names their vertices while the surface is mended.
constexpr const char* kVertexOfFile = "vertex of the file";

std::vector<std::uint32_t> take_vertices(IndexedFaceSet& mesh) {
  const auto it = std::ranges::find(mesh.corner_channels, std::string_view(kVertexOfFile), &Channel::name);
  std::vector<std::uint32_t> vertices = std::move(std::get<std::vector<std::uint32_t>>(it->values));
  mesh.corner_channels.erase(it);
  return vertices;
}

Result<DecimateOptions> options_of(const DecimationChoice& choice) {
  DecimateOptions decimation;
  if (choice.operation == "half-edge-collapse") decimation.operation = DecimateOperation::kHalfEdgeCollapse;
  if (choice.operation == "vertex-removal") decimation.operation = DecimateOperation::kVertexRemoval;
  decimation.target.force = choice.force_target;
  if (choice.boundary == "kept") decimation.curves.boundary = DecimateBoundary::kKept;
  if (choice.boundary == "free") decimation.curves.boundary = DecimateBoundary::kFree;
  if (choice.crease_angle) decimation.curves.crease_angle = *choice.crease_angle / kDegrees;
  decimation.prune_size = length_of(choice.prune_size, choice.prune_relative_size);
  VKMESH_TRY(decimation.weights, choice.criteria->weights());
  decimation.bounds = choice.criteria->bounds();
  decimation.bounds.normal_deviation = choice.max_normal_deviation / kDegrees;
  return decimation;
}

}  // namespace

std::string describe(const CountByReason& counts) {
  std::vector<ReasonText> all(std::begin(kReasonTexts), std::end(kReasonTexts));
  std::ranges::stable_sort(all, std::greater(), [&](const ReasonText& r) { return counts[r.reason]; });
  std::string text;
  for (const ReasonText& r : all)
    if (counts[r.reason] > 0)
      text += (text.empty() ? "" : ", ") + grouped(counts[r.reason]) + " (" + r.text + ")";
  return text.empty() ? "nothing" : text;
}

std::vector<std::uint32_t> isolated_points(const HalfEdgeMesh& mesh, std::size_t points) {
  std::vector<bool> used(points);
  for (const std::uint32_t p : mesh.origins()) used[p] = true;
  std::vector<std::uint32_t> found;
  for (std::size_t p = 0; p < points; ++p)
    if (!used[p]) found.push_back(static_cast<std::uint32_t>(p));
  return found;
}

Result<DecimationInput> DecimationInput::read(Job& job, const DecimationChoice& choice, bool keep_buffer) {
  DecimationInput input;
  VKMESH_TRY(IndexedFaceSet mesh, job.read());
  input.read_ = std::chrono::steady_clock::now();
  if (mesh.face_count() == 0)
    return fail(ErrorCode::kUnsuitable, "a point cloud has no faces to simplify",
                {job.options().input, {}, {}});
  if (keep_buffer) {
    set_channel(mesh.corner_channels, {kVertexOfFile, 1, mesh.corners, {}});
    input.buffer = {mesh.points, mesh.point_channels};
  }
  VKMESH_TRY(input.half_edges, job.consolidate_triangles(mesh));
  if (!mesh.is_triangles()) {
    job.note("polygons were cut into triangles");
    VKMESH_TRY(Triangulated cut, triangulate(mesh));  // as the half-edges were
    mesh = std::move(cut.mesh);
  }
  if (keep_buffer) input.vertex_of_corner = take_vertices(mesh);
  VKMESH_TRY(input.chosen_, options_of(choice));
  DecimateLocks& locked = input.chosen_.locked;
  if (!choice.attributes.lock.empty()) {
    VKMESH_TRY(Marked marked, find_marked(mesh, choice.attributes.lock));
    locked.vertices = std::move(marked.vertices);
    locked.faces = std::move(marked.faces);
  }
  if (const auto ends = ends_on_shared_curves(input.half_edges, mesh.points); !ends.empty()) {
    job.note(count_of(ends.size(), "point") +
             " on curves where three sheets or more meet stay in place, or gaps would open between them");
    locked.vertices.insert(locked.vertices.end(), ends.begin(), ends.end());
  }
  VKMESH_TRY(input.attributes,
             SimplifyAttributes::of(job, mesh, input.half_edges, choice.attributes, choice.points_stay()));
  input.attributes.tell_apart(input.vertex_of_corner);
  // The half-edges hold the corners from here on; what is let go now keeps the peak of memory low.
  input.points = std::move(mesh.points);
  return input;
}

DecimateOptions DecimationInput::options() const {
  DecimateOptions options = chosen_;
  attributes.add_to(options);
  return options;
}

std::optional<double> DecimationInput::seconds_left(const std::optional<double>& limit) const {
  if (!limit) return std::nullopt;
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - read_;
  return std::max(0.0, *limit - passed.count());
}

void add_decimation_options(CLI::App& command, const std::shared_ptr<DecimationChoice>& choice) {
  command
      .add_option("--operation", choice->operation,
                  "edge-collapse (default): both ends become one point, which may be new;\n"
                  "half-edge-collapse: one end moves to the other, no new points are made;\n"
                  "vertex-removal: a point goes, and the best triangles fill the hole")
      ->type_name("NAME")
      ->check(CLI::IsMember({"edge-collapse", "half-edge-collapse", "vertex-removal"}));
  command
      .add_option("--boundary", choice->boundary,
                  "kept: boundary points stay; in-shape (default): the boundary's shape counts in\n"
                  "the error; free: it may shrink")
      ->type_name("NAME")
      ->check(CLI::IsMember({"kept", "in-shape", "free"}));
  command
      .add_option(
          "--attribute", choice->attributes.weights,
          "What an attribute of points or corners counts in the error. At weight 1 a change over its\n"
          "whole range counts as a move by the diagonal of the bounding box; default 0.01. More than\n"
          "one may be given; all: each. Without being named, all count but normals (those of points\n"
          "are made to fit) and what numbers things; seams stay closed. A weight of 0: what points\n"
          "have is made to fit, what corners have is left out, and its seams with it")
      ->type_name("NAME[=WEIGHT]");
  command
      .add_option("--drop-attribute", choice->attributes.dropped,
                  "Leave an attribute of this name out, and its seams with it; more than one may be given")
      ->type_name("NAME");
  command.add_flag("!--no-material-borders", choice->attributes.material_borders,
                   "Let borders between materials (or other values of faces) go; else they are seams");
  command
      .add_option("--crease-angle", choice->crease_angle,
                  "Edges bent by at least so many degrees are creases, whose shape counts in the error\n"
                  "as that of the boundary does; default none")
      ->type_name("DEG")
      ->check(number_between(0.001, 180));
  command.add_flag("--force-target", choice->force_target,
                   "Go on to a target that what is locked, kept or on seams puts out of reach, whatever\n"
                   "becomes of the rest; else an eighth of the asked share is left of what may go");
  command
      .add_option("--max-normal-deviation", choice->max_normal_deviation,
                  "Do no collapse that turns a remaining face by more than this, in degrees;\n"
                  "from 0.001 to 179.999, default 75")
      ->type_name("DEG")
      ->check(number_between(0.001, 179.999));
  command
      .add_option("--lock", choice->attributes.lock,
                  "Name of an attribute: points and faces where it is not 0 stay as they are")
      ->type_name("NAME");
  CLI::Option* prune =
      command
          .add_option("--prune-size", choice->prune_size,
                      "First take away components whose bounding box has a diagonal of at most this, in\n"
                      "units of the file's coordinates; that of most triangles always stays")
          ->type_name("SIZE")
          ->check(number_between(0, std::numeric_limits<double>::max()));
  command
      .add_option("--prune-relative-size", choice->prune_relative_size,
                  "The same as a share of the whole mesh's diagonal")
      ->type_name("SIZE")
      ->check(number_between(0, std::numeric_limits<double>::max()))
      ->excludes(prune);
  add_simplify_criteria(command, std::shared_ptr<SimplifyCriteria>(choice, choice->criteria.get()));
}

}  // namespace vkmesh::cli
