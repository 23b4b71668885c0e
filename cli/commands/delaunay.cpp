// vkmesh delaunay: the Delaunay triangulation of points.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/analysis/triangle_angles.h>
#include <vkmesh/io/svg.h>
#include <vkmesh/planar/delaunay.h>

#include "commands.h"
#include "job/triangle_angles.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct DelaunayChoice {
  bool keep_heights = false, dots = false, circumcircles = false;
};

/// The triangles as a picture.
Result<void> draw(Job& job, const DelaunayChoice& choice, const DelaunayTriangulation& made,
                  std::span<const DVec2> points) {
  std::vector<DVec2> places;
  for (const std::uint32_t i : made.point_of_vertex) places.push_back(points[i]);
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
  VKMESH_CHECK(job.check_output_or_picture());
  if ((choice.dots || choice.circumcircles) && !job.draws())
    return fail(ErrorCode::kUsage, std::string(choice.dots ? "--dots" : "--circumcircles") +
                                       " goes with a picture: an output whose name ends in .svg");
  if (choice.keep_heights && job.draws()) return fail(ErrorCode::kUsage, "--z: a picture holds no heights");
  use_host(job);
  VKMESH_TRY(const IndexedFaceSet input, job.read());
  std::vector<DVec2> points;
  points.reserve(input.points.size());
  bool has_heights = false;
  for (const Vec3& p : input.points) {
    points.emplace_back(p.x, p.y);
    has_heights = has_heights || p.z != input.points[0].z;
  }
  VKMESH_TRY(const DelaunayTriangulation made,
             job.timed("compute", [&] { return delaunay(points, job.progress("triangulating")); }));
  IndexedFaceSet mesh;
  std::size_t other_heights = 0;
  for (const std::uint32_t i : made.point_of_vertex) {
    const Vec3& p = input.points[i];
    mesh.points.emplace_back(p.x, p.y, choice.keep_heights ? p.z : 0.0f);
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    other_heights += input.points[i].z != input.points[made.point_of_vertex[made.vertex_of_point[i]]].z;
  mesh.corners.assign(made.mesh.origins().begin(), made.mesh.origins().end());
  mesh.point_channels = gather(input.point_channels, made.point_of_vertex);

  if (input.face_count() > 0) job.note("the faces of the file were left out: only its points count");
  if (mesh.face_count() == 0) job.note("there are no triangles, since all points lie on one line");
  if (!choice.keep_heights && has_heights && !job.draws()) job.note("heights were left out; --z keeps them");
  if (choice.keep_heights && other_heights > 0)
    job.note(count_of(other_heights, "point") +
             " above or below another were left out: the first height of a place counts");
  if (std::erase_if(mesh.point_channels, [](const Channel& c) { return c.name == "normal"; }) > 0)
    job.note("normals were left out; vkmesh normals makes new ones");
  VKMESH_TRY(const TriangleAngles angles, triangle_angles(made.mesh, mesh.points));
  const std::size_t duplicates = points.size() - mesh.points.size(),
                    hull = made.mesh.boundary_half_edge_count();
  job.json()["result"] = {{"vertices", mesh.points.size()},
                          {"duplicates", duplicates},
                          {"triangles", mesh.face_count()},
                          {"hull_edges", hull},
                          {"angles", json_of(angles)}};
  job.row("triangles", grouped(mesh.face_count()) + "; " + count_of(hull, "edge") + " on the convex hull");
  if (duplicates > 0) job.row("duplicates", count_of(duplicates, "point") + " at the place of another");
  job.row("angles", text_of(angles, mesh.face_count()));
  return job.draws() ? draw(job, choice, made, points) : job.write(mesh);
}

}  // namespace

void add_delaunay(CLI::App& app, Program& program) {
  CLI::App* command =
      app.add_subcommand("delaunay", "Triangulates points in the plane, so that no circle holds another");
  command->footer(
      "The Delaunay triangulation of the points of a file by their x and y; its faces do not count. The "
      "triangles\n"
      "cover the convex hull. Equal points are one. It is exact, and the same for any order of the points.\n"
      "Lines of two numbers in XYZ and CSV files are points, too. An output whose name ends in .svg is a "
      "picture.\n"
      "Runs on the host.\n\n"
      "Examples:\n"
      "  vkmesh delaunay data/cgal/meshes/elephant.off flat.ply\n"
      "  vkmesh delaunay data/cgal/meshes/elephant.off surface.ply --z\n"
      "  vkmesh delaunay data/cgal/meshes/elephant.off flat.svg --circumcircles");
  add_common_options(*command, program.options, true, true);
  const auto choice = std::make_shared<DelaunayChoice>();
  command->add_flag("--z", choice->keep_heights, "Keep heights: a surface over the plane, as a terrain is");
  command->add_flag("--dots", choice->dots, "In a picture, draw the points");
  command->add_flag("--circumcircles", choice->circumcircles,
                    "In a picture, draw the circles through the corners of triangles");
  command->callback([&program, choice] {
    program.command = "delaunay";
    program.options.planar = true;
    program.action = [choice](Job& job) { return run(job, *choice); };
  });
}

}  // namespace vkmesh::cli
