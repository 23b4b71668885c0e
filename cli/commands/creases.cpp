// vkmesh creases: edges where the surface bends, as polylines.
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <vkmesh/analysis/creases.h>

#include "commands.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct Degrees {
  double sharp = 40, soft = 20;
};

// Lines fit into OBJ only, so a name that asks for another format asks for what it would not get.
Result<void> check_output(const std::string& output) {
  if (output.empty() || output == "-") return {};
  if (std::filesystem::path(output).extension() != ".obj")
    return fail(ErrorCode::kUsage, "creases are written as .obj only", {output, {}, {}});
  return check_place(output);
}

Result<void> run(Job& job, CreaseOptions options, const Degrees& degrees) {
  if (degrees.soft > degrees.sharp) return fail(ErrorCode::kUsage, "--soft must not be larger than --sharp");
  options.sharp_angle = degrees.sharp / kDegrees;
  options.soft_angle = degrees.soft / kDegrees;
  VKMESH_CHECK(check_output(job.options().output));
  VKMESH_TRY(Backend backend, open_backend(job));
  VKMESH_TRY(IndexedFaceSet mesh, job.read());
  VKMESH_TRY(const HalfEdgeMesh half_edges, job.consolidate_triangles(mesh));
  VKMESH_TRY(const DihedralAngles angles, backend.run(dihedral_angles_pass(), {half_edges, mesh.points}));
  VKMESH_TRY(const std::vector<Crease> creases, job.timed("trace", [&] {
    return find_creases(half_edges, mesh.points, angles.half_edge, options);
  }));

  std::size_t edges = 0, loops = 0;
  double length = 0;
  std::vector<std::vector<std::uint32_t>> polylines;
  for (const Crease& crease : creases) {
    edges += crease.half_edges.size();
    loops += crease.closed ? 1 : 0;
    length += crease.length;
    polylines.push_back(crease.vertices);
    if (crease.closed) polylines.back().push_back(crease.vertices.front());
  }
  job.json()["result"] = {
      {"creases", creases.size()}, {"loops", loops}, {"edges", edges}, {"length", length}};
  job.row("creases", count_of(creases.size(), "chain") + ", " + count_of(loops, "loop") + " among them, of " +
                         count_of(edges, "edge") + ", length " + brief(length));
  if (job.options().output.empty()) return {};
  return job.timed(
      "write", [&] { return write_polylines(job.options().output, mesh.points, polylines, job.offset()); });
}

}  // namespace

void add_creases(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("creases", "Finds the edges where the surface bends, as polylines");
  command->footer(
      "Edges bent by --sharp degrees or more are creases, and so are those of --soft or more that carry one "
      "on.\nThey are joined into chains, which OUT holds as the lines of an OBJ file; without OUT they are "
      "counted.\n\n"
      "Example:\n  vkmesh creases data/cgal/meshes/fandisk.off creases.obj --sharp 35 --soft 15");
  add_common_options(*command, program.options, true, false);
  command
      ->add_option("OUT", program.options.output,
                   "OBJ file to write; - for standard output. Without it creases are only counted")
      ->type_name("");
  add_consolidate_options(*command, program.options);
  add_keep_splits(*command, program.options);
  const auto options = std::make_shared<CreaseOptions>();
  const auto degrees = std::make_shared<Degrees>();
  command->add_option("--sharp", degrees->sharp, "Degrees from which an edge is a crease; default 40")
      ->type_name("DEGREES")
      ->check(number_between(0, 180));
  command->add_option("--soft", degrees->soft, "Degrees from which an edge carries a crease on; default 20")
      ->type_name("DEGREES")
      ->check(number_between(0, 180));
  command
      ->add_option("--min-length", options->min_length,
                   "Leave out loose ends and pieces shorter than this, in the mesh's units; default 0")
      ->type_name("LENGTH")
      ->check(number_between(0, 1e30));
  const std::map<std::string, CreaseKind> kinds = {
      {"both", CreaseKind::kBoth}, {"convex", CreaseKind::kConvex}, {"concave", CreaseKind::kConcave}};
  command->add_option("--kind", options->kind, "Which edges: both (default), convex or concave ones")
      ->type_name("both|convex|concave")
      ->transform(one_of(kinds));
  command->add_flag("--with-boundary", options->boundary, "Boundary edges are creases too");
  command->callback([&program, options, degrees] {
    program.command = "creases";
    program.action = [options, degrees](Job& job) { return run(job, *options, *degrees); };
  });
}

}  // namespace vkmesh::cli
