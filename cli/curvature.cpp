// vkmesh curvature: the largest dihedral angle around each vertex.
#include <algorithm>
#include <numbers>

#include "backend.h"
#include "commands.h"

namespace vkmesh::cli {
namespace {

Result<void> run(Job& job) {
  VKMESH_CHECK(job.check_output());
  VKMESH_TRY(const std::unique_ptr<Backend> backend, open_backend(job));
  VKMESH_TRY(IndexedFaceSet mesh, job.read());
  VKMESH_TRY(const HalfEdgeMesh half_edges, job.consolidate_triangles(mesh));
  VKMESH_TRY(std::vector<float> angles, backend->largest_dihedral_angles(half_edges, mesh.points));

  double sum = 0, largest = 0;
  for (const float angle : angles) {
    sum += static_cast<double>(angle);
    largest = std::max(largest, static_cast<double>(angle));
  }
  const double mean = angles.empty() ? 0 : sum / static_cast<double>(angles.size());
  constexpr double kDegrees = 180 / std::numbers::pi;
  job.json()["result"] = {{"unit", "radians"}, {"mean", mean}, {"largest", largest}};
  job.row("angles", "mean " + brief(mean) + ", largest " + brief(largest) + " radians (" +
                        brief(mean * kDegrees) + " and " + brief(largest * kDegrees) + " degrees)");
  set_channel(mesh.point_channels, {"quality", 1, std::move(angles)});
  return job.write(mesh);
}

}  // namespace

void add_curvature(CLI::App& app, Program& program) {
  CLI::App* command =
      app.add_subcommand("curvature", "Computes the largest dihedral angle around each vertex");
  command->footer(
      "Written as the PLY property quality, in radians: 0 where the surface is flat, pi where it folds back "
      "on itself.\n"
      "Polygons stay; their angles are those of the triangles they are cut into. Every device gives the same "
      "bytes.\n\n"
      "Example:\n  vkmesh curvature data/dragon/dragon_vrip.ply.gz curvature.ply");
  add_common_options(*command, program.options, true, true);
  add_consolidate_options(*command, program.options);
  command->callback([&program] {
    program.command = "curvature";
    program.action = run;
  });
}

}  // namespace vkmesh::cli
