// vkmesh delaunay: Delaunay triangulations of points, of outlines and of lines between them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <vkmesh/analysis/triangle_angles.h>
#include <vkmesh/io/svg.h>
#include <vkmesh/planar/constrained_delaunay.h>
#include <vkmesh/planar/delaunay.h>

#include "commands.h"
#include "job/channels.h"
#include "job/constraint_file.h"
#include "job/triangle_angles.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct DelaunayChoice {
  bool keep_heights = false, dots = false, circumcircles = false, split_crossings = false;
  std::string constraints;
  DelaunayDomain domain = DelaunayDomain::kConvexHull;
  std::optional<double> min_angle, max_area, min_edge;
  std::optional<std::size_t> max_points;

  [[nodiscard]] bool refines() const { return min_angle || max_area; }
};

std::optional<DelaunayRefinement> refinement_of(const DelaunayChoice& choice) {
  if (!choice.refines()) return {};
  DelaunayRefinement refinement;
  refinement.min_angle = choice.min_angle.value_or(0) / kDegrees;
  refinement.max_area = choice.max_area;
  refinement.max_points = choice.max_points;
  refinement.min_edge = choice.min_edge.value_or(0);
  return refinement;
}

Result<void> check(const DelaunayChoice& choice) {
  const auto refuse = [](const char* sentence) { return fail(ErrorCode::kUsage, sentence); };
  if (!choice.refines() && (choice.max_points || choice.min_edge))
    return refuse(
        "--max-points and --min-edge bound what --min-angle or --max-area do, and neither is given");
  if (choice.constraints.empty() && (choice.split_crossings || choice.domain != DelaunayDomain::kConvexHull))
    return refuse("--split-crossings and --inside are about --constraints, which are not given");
  return {};
}

/// The lines of the file of constraints; its points are added to those of the input, unless it is the input.
Result<ConstraintFile> read_lines(Job& job, const DelaunayChoice& choice, IndexedFaceSet& input) {
  VKMESH_TRY(ConstraintFile file, read_constraints(choice.constraints));
  if (!file.has_points) return file;
  std::error_code error;
  if (std::filesystem::equivalent(choice.constraints, job.options().input, error)) {
    if (file.points.size() != input.points.size())
      return fail(ErrorCode::kUnreadable, "points were left out, and so its lines name others",
                  {choice.constraints, {}, {}});
    return file;
  }
  const auto first = static_cast<std::uint32_t>(input.points.size());
  for (auto* segments : {&file.lines, &file.loops})
    for (PointPair& segment : *segments) segment = {segment[0] + first, segment[1] + first};
  for (const DVec3& p : file.points) input.points.emplace_back(p - job.offset());
  // They have the attributes of none: those of the input's points do not fit any more.
  if (!input.point_channels.empty()) {
    job.note("attributes of points were left out, since those of the constraints have none");
    input.point_channels.clear();
  }
  return file;
}

Result<ConstrainedTriangulation> triangulate(Job& job, const DelaunayChoice& choice,
                                             const std::vector<DVec2>& points, ConstraintFile& lines) {
  if (choice.constraints.empty() && !choice.refines()) {
    VKMESH_TRY(DelaunayTriangulation plain, delaunay(points, job.progress("triangulating")));
    ConstrainedTriangulation made;
    made.mesh = std::move(plain.mesh);
    for (const std::uint32_t i : plain.point_of_vertex) made.positions.push_back(points[i]);
    made.point_of_vertex = std::move(plain.point_of_vertex);
    made.vertex_of_point = std::move(plain.vertex_of_point);
    return made;
  }
  ConstrainedDelaunayOptions options;
  options.domain = choice.domain;
  options.split_crossings = choice.split_crossings;
  options.refinement = refinement_of(choice);
  if (choice.domain == DelaunayDomain::kConvexHull)
    lines.lines.insert(lines.lines.end(), lines.loops.begin(), lines.loops.end());
  else
    options.outlines = lines.loops;
  return constrained_delaunay(points, lines.lines, options, job.progress("triangulating"));
}

/// The vertices of the result, and for each a point whose attributes it has: of those that were added that
/// with the greatest weight.
struct PlanarVertices {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> sources;
};
PlanarVertices vertices_of(const ConstrainedTriangulation& made, const IndexedFaceSet& input,
                           bool keep_heights) {
  PlanarVertices result;
  const std::size_t given = made.point_of_vertex.size() - made.added.size();
  for (std::size_t v = 0; v < made.point_of_vertex.size(); ++v) {
    const std::uint32_t source = made.point_of_vertex[v];
    if (source != kInvalid) {
      const Vec3& p = input.points[source];
      result.points.emplace_back(p.x, p.y, keep_heights ? p.z : 0.0f);
      result.sources.push_back(source);
      continue;
    }
    const AddedVertex& from = made.added[v - given];
    float height = 0;
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      height += from.weights[i] * result.points[from.vertices[i]].z;
      if (from.weights[i] > from.weights[nearest]) nearest = i;
    }
    result.points.emplace_back(static_cast<float>(made.positions[v].x),
                               static_cast<float>(made.positions[v].y), height);
    result.sources.push_back(result.sources[from.vertices[nearest]]);
  }
  return result;
}

/// Leaves out points that are in no triangle.
void drop_isolated(IndexedFaceSet& mesh) {
  std::vector<std::uint32_t> number(mesh.points.size(), kInvalid), kept;
  for (const std::uint32_t v : mesh.corners) number[v] = 0;
  for (std::uint32_t v = 0; v < number.size(); ++v)
    if (number[v] == 0) {
      number[v] = static_cast<std::uint32_t>(kept.size());
      mesh.points[kept.size()] = mesh.points[v];
      kept.push_back(v);
    }
  mesh.points.resize(kept.size());
  for (std::uint32_t& v : mesh.corners) v = number[v];
  mesh.point_channels = gather(mesh.point_channels, kept);
}

void report(Job& job, const DelaunayChoice& choice, const ConstrainedTriangulation& made,
            const ConstraintFile& lines) {
  Json& result = job.json()["result"];
  if (!choice.constraints.empty()) {
    const std::size_t given =
        lines.lines.size() + (choice.domain == DelaunayDomain::kConvexHull ? 0 : lines.loops.size());
    result["constraints"] = {
        {"segments", given}, {"edges", made.constrained_edges.size()}, {"crossings", made.crossings}};
    job.row("constraints", count_of(given, "segment") + " in " +
                               count_of(made.constrained_edges.size(), "edge") +
                               (made.crossings > 0 ? "; " + count_of(made.crossings, "crossing") : ""));
  }
  if (!choice.refines()) return;
  std::array<std::size_t, 3> left{};
  for (const UnrefinedTriangle& t : made.unrefined) ++left[static_cast<std::size_t>(t.reason)];
  result["refinement"] = {
      {"added", made.refined_points},
      {"left", {{"input_angle", left[0]}, {"max_points", left[1]}, {"min_edge", left[2]}}}};
  job.row("refined", count_of(made.refined_points, "point") + " added; " +
                         count_of(made.unrefined.size(), "triangle") + " left as " +
                         (made.unrefined.size() == 1 ? "it is" : "they are"));
  constexpr std::array<const char*, 3> kReasons = {" at a smaller angle between constraints",
                                                   " when there were as many points as --max-points allows",
                                                   " whose edges would become too short"};
  for (std::size_t i = 0; i < 3; ++i)
    if (left[i] > 0) job.note(count_of(left[i], "triangle") + " left" + kReasons[i]);
}

/// The triangles as a picture.
Result<void> draw(Job& job, const DelaunayChoice& choice, const ConstrainedTriangulation& made) {
  const std::vector<DVec2>& places = made.positions;
  SvgPicture picture;
  picture.points = places;
  picture.corners = made.mesh.origins();
  if (choice.dots || made.mesh.face_count() == 0) picture.dots = places;
  std::vector<SvgCircle> circles;
  for (std::size_t f = 0; choice.circumcircles && f < made.mesh.face_count(); ++f) {
    const std::span<const std::uint32_t> corner = made.mesh.origins().subspan(3 * f, 3);
    const DVec2 a = places[corner[0]], b = places[corner[1]] - a, c = places[corner[2]] - a;
    const double twice = 2 * (b.x * c.y - b.y * c.x), bb = b.x * b.x + b.y * b.y, cc = c.x * c.x + c.y * c.y;
    const DVec2 to((c.y * bb - b.y * cc) / twice, (b.x * cc - c.x * bb) / twice);
    const SvgCircle circle{a + to, std::hypot(to.x, to.y)};
    // Circles of needles may be too large for a number.
    if (std::fabs(circle.centre.x) + std::fabs(circle.centre.y) + circle.radius <
        std::numeric_limits<float>::max())
      circles.push_back(circle);
  }
  picture.circles = circles;
  return job.write(picture);
}

Result<void> run(Job& job, const DelaunayChoice& choice) {
  VKMESH_CHECK(check(choice));
  VKMESH_CHECK(job.check_output_or_picture());
  if ((choice.dots || choice.circumcircles) && !job.draws())
    return fail(ErrorCode::kUsage, std::string(choice.dots ? "--dots" : "--circumcircles") +
                                       " goes with a picture: an output whose name ends in .svg");
  if (choice.keep_heights && job.draws()) return fail(ErrorCode::kUsage, "--z: a picture holds no heights");
  use_host(job);
  VKMESH_TRY(IndexedFaceSet input, job.read());
  ConstraintFile lines;
  if (!choice.constraints.empty()) {
    VKMESH_TRY(lines, job.timed("read", [&] { return read_lines(job, choice, input); }));
  }
  std::vector<DVec2> points;
  points.reserve(input.points.size());
  bool has_heights = false;
  for (const Vec3& p : input.points) {
    points.emplace_back(p.x, p.y);
    has_heights = has_heights || p.z != input.points[0].z;
  }
  VKMESH_TRY(const ConstrainedTriangulation made,
             job.timed("compute", [&] { return triangulate(job, choice, points, lines); }));
  IndexedFaceSet mesh;
  PlanarVertices vertices = vertices_of(made, input, choice.keep_heights);
  mesh.points = std::move(vertices.points);
  mesh.corners.assign(made.mesh.origins().begin(), made.mesh.origins().end());
  mesh.point_channels = gather(input.point_channels, vertices.sources);
  std::size_t other_heights = 0, turned_over = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    other_heights += input.points[i].z != input.points[made.point_of_vertex[made.vertex_of_point[i]]].z;
  if (!made.added.empty())
    for (std::size_t f = 0; f < made.mesh.face_count(); ++f) {
      std::array<DVec2, 3> corner;
      for (std::size_t i = 0; i < 3; ++i) corner[i] = DVec2(mesh.points[mesh.corners[3 * f + i]]);
      turned_over += orientation(corner[0], corner[1], corner[2]) <= 0 ? 1 : 0;
    }

  if (input.face_count() > 0 && choice.constraints != job.options().input)
    VKMESH_CHECK(job.note_dropped("faces", "the faces were left out: only the points count"));
  if (mesh.face_count() == 0)
    job.note(choice.domain == DelaunayDomain::kConvexHull
                 ? "there are no triangles, since all points lie on one line"
                 : "there are no triangles: no closed line winds around any");
  if (!choice.keep_heights && has_heights && !job.draws())
    VKMESH_CHECK(job.note_dropped("heights", "heights were left out; --z keeps them"));
  if (choice.keep_heights && other_heights > 0)
    VKMESH_CHECK(job.note_dropped(
        "heights", count_of(other_heights, "point") +
                       " above or below another were left out: the first height of a place counts"));
  if (turned_over > 0)
    job.note(count_of(turned_over, "triangle") + " without area, or turned over, in single precision");
  VKMESH_CHECK(drop_normals(job, {&mesh.point_channels}));
  VKMESH_TRY(const TriangleAngles angles, triangle_angles(made.mesh, mesh.points));
  const bool whole = choice.domain == DelaunayDomain::kConvexHull;
  if (!whole && mesh.face_count() > 0) drop_isolated(mesh);
  const std::size_t duplicates = points.size() + made.added.size() - made.point_of_vertex.size(),
                    border = made.mesh.boundary_half_edge_count();
  job.json()["result"] = {{"vertices", mesh.points.size()},
                          {"duplicates", duplicates},
                          {"triangles", mesh.face_count()},
                          {whole ? "hull_edges" : "boundary_edges", border},
                          {"angles", json_of(angles)}};
  job.row("triangles", grouped(mesh.face_count()) + "; " + count_of(border, "edge") +
                           (whole ? " on the convex hull" : " on the boundary"));
  if (duplicates > 0) job.row("duplicates", count_of(duplicates, "point") + " at the place of another");
  report(job, choice, made, lines);
  job.row("angles", text_of(angles, mesh.face_count()));
  return job.draws() ? draw(job, choice, made) : job.write(mesh);
}

}  // namespace

void add_delaunay(CLI::App& app, Program& program) {
  CLI::App* command =
      app.add_subcommand("delaunay", "Triangulates points in the plane, so that no circle holds another");
  command->footer(
      "The Delaunay triangulation of the points of a file by their x and y; its faces do not count. The "
      "triangles\n"
      "cover the convex hull. Equal points are one. It is exact, and the same for any order of the points.\n"
      "Constraints are lines that become edges: those of an OBJ file (l, and the outlines of its faces, f) "
      "with\n"
      "its own points, which may be the file of points itself; or a text file with two numbers a line, each "
      "of\n"
      "a point of the input, the first being 0. Lines that end where they began are the outlines that "
      "--inside\n"
      "means. Lines of two numbers in XYZ and CSV files are points, too. An output whose name ends in .svg "
      "is a\n"
      "picture. Runs on the host.\n\n"
      "Examples:\n"
      "  vkmesh delaunay data/cgal/meshes/elephant.off flat.ply\n"
      "  vkmesh delaunay data/cgal/meshes/elephant.off surface.ply --z\n"
      "  vkmesh delaunay data/cgal/meshes/elephant.off even.ply --min-angle 25 --max-points 100000\n"
      "  vkmesh delaunay data/cgal/meshes/elephant.off flat.svg --circumcircles");
  add_common_options(*command, program.options, true, true);
  const auto choice = std::make_shared<DelaunayChoice>();
  command->add_flag("--z", choice->keep_heights, "Keep heights: a surface over the plane, as a terrain is");
  command->add_flag("--dots", choice->dots, "In a picture, draw the points");
  command->add_flag("--circumcircles", choice->circumcircles,
                    "In a picture, draw the circles through the corners of triangles");
  command
      ->add_option("--constraints", choice->constraints,
                   "Lines that must be edges: an OBJ file, or one of pairs of point numbers")
      ->type_name("FILE");
  command->add_flag("--split-crossings", choice->split_crossings,
                    "Put a point where constraints cross; else they are refused");
  command
      ->add_option_function<unsigned>(
          "--inside", [choice](unsigned rule) { choice->domain = static_cast<DelaunayDomain>(rule); },
          "Keep what closed lines wind around: a number of times that is not zero, or that is odd")
      ->transform(one_of(std::map<std::string, DelaunayDomain>{{"nonzero", DelaunayDomain::kNonZero},
                                                               {"even-odd", DelaunayDomain::kEvenOdd}}))
      ->type_name("nonzero|even-odd");
  constexpr double kLeast = std::numeric_limits<double>::min(), kMost = std::numeric_limits<double>::max();
  command
      ->add_option("--min-angle", choice->min_angle, "Add points until no angle is smaller; up to 33 serves")
      ->type_name("DEGREES")
      ->check(number_between(0, 59.9));
  command->add_option("--max-area", choice->max_area, "Add points until no triangle is larger")
      ->type_name("AREA")
      ->check(number_between(kLeast, kMost));
  command
      ->add_option("--max-points", choice->max_points, "Add at most so many; else a million and ten a point")
      ->type_name("N")
      ->check(count_up_to(std::uint64_t{1} << 29));
  command->add_option("--min-edge", choice->min_edge, "Make no edge shorter than this")
      ->type_name("LENGTH")
      ->check(number_between(0, kMost));
  command->callback([&program, choice] {
    program.command = "delaunay";
    program.options.planar = true;
    program.action = [choice](Job& job) { return run(job, *choice); };
  });
}

}  // namespace vkmesh::cli
