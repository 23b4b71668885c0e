// vkmesh normals: vertex normals.
#include <map>
#include <memory>
#include <string>

#include "commands.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

Result<void> run(Job& job, const VertexNormalsOptions& options) {
  VKMESH_CHECK(job.check_output());
  VKMESH_TRY(Backend backend, open_backend(job));
  VKMESH_TRY(IndexedFaceSet mesh, job.read());
  VKMESH_TRY(const HalfEdgeMesh half_edges, job.connect(mesh));
  // Kernels take triangles.
  VKMESH_TRY(const std::vector<Vec3> normals,
             half_edges.is_triangles()
                 ? backend.run(vertex_normals_pass(options), {half_edges, mesh.points})
                 : job.timed("compute", [&] { return vertex_normals(half_edges, mesh.points, options); }));

  std::size_t undefined = 0;
  std::vector<float> values;
  values.reserve(3 * normals.size());
  for (const Vec3& n : normals) {
    values.insert(values.end(), {n.x, n.y, n.z});
    undefined += n == Vec3(0.0f) ? 1u : 0u;
  }
  std::erase_if(mesh.corner_channels, [](const Channel& channel) { return channel.name == "normal"; });
  set_channel(mesh.point_channels, {"normal", 3, std::move(values)});
  job.json()["result"] = {{"normals", normals.size()}, {"undefined", undefined}};
  job.row(
      "normals",
      grouped(normals.size()) +
          (undefined ? ", " + grouped(undefined) + " of them zero: no face around gives a direction" : ""));
  return job.write(mesh);
}

}  // namespace

void add_normals(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("normals", "Computes vertex normals");
  command->footer(
      "Written as the PLY properties nx ny nz (OBJ: vn), beside what the input holds. A polygon counts as "
      "one "
      "face, by its\nown area and its own angles, and meshes that have some are computed on the CPU. Every "
      "device gives the same bytes.\n\n"
      "Example:\n  vkmesh normals data/dragon/dragon_vrip.ply.gz normals.ply");
  add_common_options(*command, program.options, true, true);
  add_consolidate_options(*command, program.options);
  add_keep_splits(*command, program.options);
  const auto options = std::make_shared<VertexNormalsOptions>();
  const std::map<std::string, NormalWeights> weights = {
      {"area", NormalWeights::kArea}, {"angle", NormalWeights::kAngle}, {"uniform", NormalWeights::kUniform}};
  command
      ->add_option("--weights", options->weights,
                   "How much each face around a vertex counts: by its area (default), by its angle at\n"
                   "the vertex, or uniform")
      ->type_name("area|angle|uniform")
      ->transform(one_of(weights));
  command->callback([&program, options] {
    program.command = "normals";
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
