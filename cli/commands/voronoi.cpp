// vkmesh voronoi: the Voronoi diagram of points.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/io/svg.h>
#include <vkmesh/mesh/triangulate.h>
#include <vkmesh/planar/voronoi.h>
#include <vkmesh/view/color_map.h>

#include "commands.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct VoronoiChoice {
  std::string box, clip;
  unsigned lloyd_iterations = 0;
  bool dots = false;
};

std::vector<DVec2> planar_points(const IndexedFaceSet& mesh) {
  std::vector<DVec2> points;
  points.reserve(mesh.points.size());
  for (const Vec3& p : mesh.points) points.emplace_back(p.x, p.y);
  return points;
}

/// The polygon to clip to, relative to what is read; empty where none is asked for.
Result<std::vector<DVec2>> clip_of(Job& job, const VoronoiChoice& choice) {
  std::vector<DVec2> clip;
  const DVec2 offset(job.offset().x, job.offset().y);
  if (!choice.box.empty()) {
    VKMESH_TRY(const std::vector<double> box, parse_numbers(choice.box, ',', 4, "--box"));
    if (!(box[0] < box[2] && box[1] < box[3]))
      return fail(ErrorCode::kUsage, "--box: the first corner must be below and left of the second");
    clip = {{box[0], box[1]}, {box[2], box[1]}, {box[2], box[3]}, {box[0], box[3]}};
    for (DVec2& p : clip) p -= offset;
  } else if (!choice.clip.empty()) {
    VKMESH_TRY(MeshFile file, read_mesh(choice.clip, job.read_options()));
    VKMESH_CHECK(job.note_differences(choice.clip, file.notes));
    VKMESH_TRY(const IndexedFaceSet mesh, to_indexed_face_set(std::move(file)));
    if (mesh.face_count() > 1)
      return fail(ErrorCode::kUnsuitable, "a polygon to clip to is one face, or points in order",
                  {choice.clip, {}, {}});
    clip = planar_points(mesh);
    if (mesh.face_count() == 1) {
      const std::vector<DVec2> points = std::move(clip);
      clip.clear();
      for (const std::uint32_t i : mesh.face(0)) clip.push_back(points[i]);
    }
  }
  return clip;
}

/// A colour for each cell that no neighbour has: of twelve, the first from one that its number chooses. Cells
/// of more neighbours than there are colours may share one.
std::vector<std::uint8_t> colors_of(const VoronoiDiagram& diagram) {
  constexpr std::uint32_t kColors = 12;
  const ColorTable table = color_table(ColorMap::kCategorical);
  std::vector<std::uint8_t> chosen(diagram.cell_count()), colors;
  for (std::uint32_t i = 0; i < diagram.cell_count(); ++i) {
    std::array<bool, kColors> taken{};
    for (const std::uint32_t k : diagram.neighbours_of(i))
      if (k < i) taken[chosen[k]] = true;
    std::uint32_t color = (i * 0x9e3779b1u >> 16) % kColors;
    for (std::uint32_t tries = 0; taken[color] && tries < kColors; ++tries) color = (color + 1) % kColors;
    chosen[i] = static_cast<std::uint8_t>(color);
  }
  colors.reserve(3 * diagram.cell_count());
  for (const std::uint8_t i : chosen) colors.insert(colors.end(), {table[i].r, table[i].g, table[i].b});
  return colors;
}

/// Cells that are not empty as faces, with their sites' numbers in the file and their colours.
IndexedFaceSet mesh_of(const VoronoiDiagram& diagram) {
  IndexedFaceSet mesh;
  for (const DVec2 p : diagram.vertices)
    mesh.points.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y), 0.0f);
  mesh.corners = diagram.corners;
  mesh.face_offsets = {0};
  const std::vector<std::uint8_t> of_cells = colors_of(diagram);
  std::vector<std::uint32_t> sites;
  std::vector<std::uint8_t> colors;
  for (std::size_t i = 0; i < diagram.cell_count(); ++i) {
    if (diagram.cell(i).empty()) continue;
    mesh.face_offsets.push_back(diagram.cell_offsets[i + 1]);
    sites.push_back(diagram.point_of_site[i]);
    colors.insert(colors.end(), &of_cells[3 * i], &of_cells[3 * i] + 3);
  }
  mesh.normalize_offsets();
  mesh.face_channels = {{"site", 1, std::move(sites)}, {"color", 3, std::move(colors)}};
  return mesh;
}

Result<void> write_cells(Job& job, const VoronoiDiagram& diagram) {
  if (job.output_format() == FileFormat::kXyz) {
    IndexedFaceSet sites;
    for (const DVec2 p : diagram.sites)
      sites.points.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y), 0.0f);
    job.note("XYZ holds points: these are the sites");
    return job.write(sites);
  }
  IndexedFaceSet mesh = mesh_of(diagram);
  const bool triangles_only =
      job.output_format() == FileFormat::kStl || job.output_format() == FileFormat::kGltf;
  if (triangles_only && !mesh.is_triangles()) {
    VKMESH_TRY(Triangulated cut, triangulate(mesh));
    mesh = std::move(cut.mesh);
    job.note("the format holds triangles only, so that the cells were cut into these");
  }
  return job.write(mesh);
}

Result<void> draw_cells(Job& job, const VoronoiDiagram& diagram, bool dots) {
  std::vector<DVec2> sites;
  for (std::size_t i = 0; dots && i < diagram.cell_count(); ++i)
    if (!diagram.cell(i).empty()) sites.push_back(diagram.sites[i]);
  const std::vector<std::uint8_t> fills = colors_of(diagram);
  SvgPicture picture;
  picture.points = diagram.vertices;
  picture.corners = diagram.corners;
  picture.face_offsets = diagram.cell_offsets;
  picture.fills = fills;
  picture.dots = sites;
  return job.write(picture);
}

Result<void> run(Job& job, const VoronoiChoice& choice) {
  VKMESH_CHECK(job.check_output_or_picture());
  if (choice.dots && !job.draws())
    return fail(ErrorCode::kUsage, "--dots goes with a picture: an output whose name ends in .svg");
  use_host(job);
  VKMESH_TRY(const IndexedFaceSet input, job.read());
  const std::vector<DVec2> points = planar_points(input);
  VoronoiOptions options;
  VKMESH_TRY(options.clip, clip_of(job, choice));
  options.lloyd_iterations = choice.lloyd_iterations;
  VKMESH_TRY(const VoronoiDiagram diagram,
             job.timed("compute", [&] { return voronoi(points, options, job.progress("dividing")); }));

  std::size_t cells = 0, edges = 0;
  double least = std::numeric_limits<double>::infinity(), most = 0, sum = 0;
  for (std::size_t i = 0; i < diagram.cell_count(); ++i) {
    if (diagram.cell(i).empty()) continue;
    const double area = diagram.area(i);
    ++cells;
    sum += area;
    least = std::min(least, area);
    most = std::max(most, area);
    for (const std::uint32_t k : diagram.neighbours_of(i)) edges += k == kInvalid || k > i ? 1 : 0;
  }
  const std::size_t empty = diagram.cell_count() - cells, duplicates = points.size() - diagram.cell_count();
  if (input.face_count() > 0)
    VKMESH_CHECK(job.note_dropped("faces", "the faces were left out: only the points count"));
  if (empty > 0)
    job.note(count_of(empty, "site") + " without a cell: all that is nearest to " +
             (empty == 1 ? "it" : "them") + " lies outside");
  job.json()["result"] = {
      {"sites", diagram.cell_count()},
      {"duplicates", duplicates},
      {"cells", cells},
      {"empty_cells", empty},
      {"vertices", diagram.vertices.size()},
      {"edges", edges},
      {"lloyd_iterations", choice.lloyd_iterations},
      {"area", {{"sum", sum}, {"least", cells > 0 ? Json(least) : Json(nullptr)}, {"most", most}}}};
  job.row("cells", grouped(cells) + "; " + count_of(diagram.vertices.size(), "vertex", "vertices") + ", " +
                       count_of(edges, "edge"));
  if (duplicates > 0) job.row("duplicates", count_of(duplicates, "point") + " at the place of another");
  job.row("areas", "from " + brief(least) + " to " + brief(most) + ", together " + brief(sum));
  return job.draws() ? draw_cells(job, diagram, choice.dots) : write_cells(job, diagram);
}

}  // namespace

void add_voronoi(CLI::App& app, Program& program) {
  CLI::App* command =
      app.add_subcommand("voronoi", "Divides the plane into cells of what is nearest to each point");
  command->footer(
      "The Voronoi diagram of the points of a file by their x and y, clipped to a box or a convex polygon: "
      "cells as\n"
      "polygons that share their vertices, with the attributes site (the number of the point in the file, "
      "from "
      "0)\n"
      "and color. Equal points share a cell. Lines of two numbers in XYZ and CSV files are points, too. An "
      "output\n"
      "whose name ends in .svg is a picture, one that ends in .xyz the sites. Runs on the host.\n\n"
      "Examples:\n"
      "  vkmesh voronoi data/cgal/meshes/elephant.off cells.ply\n"
      "  vkmesh voronoi data/cgal/meshes/elephant.off cells.svg --box -0.5,-0.5,0.5,0.5 --lloyd 20 --dots");
  add_common_options(*command, program.options, true, true);
  const auto choice = std::make_shared<VoronoiChoice>();
  CLI::Option* const box =
      command
          ->add_option("--box", choice->box,
                       "Clip to this box (default: that of the points, a tenth of its longer side wider)")
          ->type_name("X0,Y0,X1,Y1");
  command
      ->add_option("--clip", choice->clip,
                   "Clip to the convex polygon that is the one face of a mesh file, or its points in order")
      ->type_name("FILE")
      ->excludes(box);
  command
      ->add_option("--lloyd", choice->lloyd_iterations,
                   "So many times, move all sites to the centroids of their cells (default: 0)")
      ->type_name("N")
      ->check(count_up_to(1000000));
  command->add_flag("--dots", choice->dots, "In a picture, draw the sites");
  command->callback([&program, choice] {
    program.command = "voronoi";
    program.options.planar = true;
    program.action = [choice](Job& job) { return run(job, *choice); };
  });
}

}  // namespace vkmesh::cli
