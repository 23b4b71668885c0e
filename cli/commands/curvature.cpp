// vkmesh curvature: how much the surface bends at each vertex.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "commands.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct CurvatureOptions {
  std::string kind = "dihedral";
};

// One value a vertex, by --kind.
Result<std::vector<float>> values_of(Backend& backend, const std::string& kind, const HalfEdgeMesh& mesh,
                                     std::span<const Vec3> positions) {
  if (kind == "dihedral") {
    VKMESH_TRY(DihedralAngles angles, backend.run(dihedral_angles_pass(), {mesh, positions}));
    return std::move(angles.vertex_maximum);
  }
  VKMESH_TRY(const std::vector<VertexCurvature> curvatures,
             backend.run(curvatures_pass(), {mesh, positions}));
  std::vector<float> values(curvatures.size());
  for (std::size_t v = 0; v < values.size(); ++v)
    values[v] = kind == "mean" ? curvatures[v].mean : curvatures[v].gaussian;
  return values;
}

Result<void> run(Job& job, const CurvatureOptions& options) {
  VKMESH_CHECK(job.check_output());
  VKMESH_TRY(Backend backend, open_backend(job));
  VKMESH_TRY(IndexedFaceSet mesh, job.read());
  VKMESH_TRY(const HalfEdgeMesh half_edges, job.consolidate_triangles(mesh));
  VKMESH_TRY(std::vector<float> values, values_of(backend, options.kind, half_edges, mesh.points));

  double sum = 0, smallest = std::numeric_limits<double>::infinity(), largest = -smallest;
  for (const float value : values) {
    sum += static_cast<double>(value);
    smallest = std::min(smallest, static_cast<double>(value));
    largest = std::max(largest, static_cast<double>(value));
  }
  if (values.empty()) smallest = largest = 0;
  const double mean = values.empty() ? 0 : sum / static_cast<double>(values.size());
  const bool angles = options.kind == "dihedral";
  const std::string unit = angles ? "radians" : options.kind == "mean" ? "1 / length" : "1 / length^2";
  job.json()["result"] = {
      {"kind", options.kind}, {"unit", unit}, {"mean", mean}, {"smallest", smallest}, {"largest", largest}};
  job.row(
      angles ? "angles" : "curvature",
      "mean " + brief(mean) + (angles ? "" : ", smallest " + brief(smallest)) + ", largest " +
          brief(largest) + " " + unit +
          (angles ? " (" + brief(mean * kDegrees) + " and " + brief(largest * kDegrees) + " degrees)" : ""));
  set_channel(mesh.point_channels, {"quality", 1, std::move(values)});
  return job.write(mesh);
}

}  // namespace

void add_curvature(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("curvature", "Computes how much the surface bends at each vertex");
  command->footer(
      "Written as the PLY property quality. dihedral: the largest angle between neighbouring triangles "
      "around\nthe vertex, in radians: 0 where the surface is flat, pi where it folds back on itself. mean "
      "and "
      "gaussian:\npositive and 1/r, 1/r^2 on a sphere of radius r; 0 on the boundary. Polygons stay; their "
      "curvature is that\nof the triangles they are cut into. Every device gives the same bytes.\n\n"
      "Example:\n  vkmesh curvature data/dragon/dragon_vrip.ply.gz curvature.ply --kind mean");
  add_common_options(*command, program.options, true, true);
  add_consolidate_options(*command, program.options);
  add_keep_splits(*command, program.options);
  const auto options = std::make_shared<CurvatureOptions>();
  command->add_option("--kind", options->kind, "dihedral (default), mean or gaussian")
      ->type_name("KIND")
      ->check(CLI::IsMember({"dihedral", "mean", "gaussian"}).description(""));
  command->callback([&program, options] {
    program.command = "curvature";
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
