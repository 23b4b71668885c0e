// vkmesh convert: from one file format into another.
#include <string>
#include <utility>

#include <vkmesh/mesh/triangulate.h>
#include <vkmesh/repair/weld.h>

#include "commands.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct ConvertOptions {
  bool triangulate = false;
  bool as_is = false;
  bool ascii = false;
};

/// The option given that judges or repairs faces; empty for none.
std::string judging_option(const ConsolidateOptions& options) {
  if (options.strict) return "--strict";
  if (!options.keep_isolated_points) return "--drop-isolated";
  return options.cut_non_orientable ? "" : "--refuse-non-orientable";
}

Result<void> weld_cloud(Job& job, const WeldOptions& options, IndexedFaceSet& mesh) {
  VKMESH_TRY(Welded welded, job.timed("consolidate", [&] { return weld(mesh, options); }));
  mesh = std::move(welded.mesh);
  job.json()["report"] = {{"welded_points", welded.merged_points},
                          {"largest_weld_move", welded.largest_move}};
  if (welded.merged_points > 0)
    job.row("repaired", count_of(welded.merged_points, "point") + " welded to others");
  return {};
}

Result<void> run(Job& job, const ConvertOptions& options) {
  use_host(job);
  VKMESH_CHECK(job.check_output());
  const ConsolidateOptions& consolidation = job.options().consolidation;
  const std::string judging = judging_option(consolidation);
  if (options.as_is && (consolidation.weld || !judging.empty()))
    return fail(ErrorCode::kUsage, (judging.empty() ? "--weld" : judging) +
                                       " cannot act with --as-is, which judges and repairs nothing");
  VKMESH_TRY(IndexedFaceSet mesh, job.read());
  if (mesh.face_count() == 0) {
    if (!judging.empty())
      return fail(ErrorCode::kUsage, judging + " cannot act: the input is a point cloud, without faces",
                  {job.options().input, {}, {}});
    if (consolidation.weld) VKMESH_CHECK(weld_cloud(job, *consolidation.weld, mesh));
  } else if (!options.as_is) {
    VKMESH_TRY(const HalfEdgeMesh half_edges, job.consolidate(mesh));
    if (job.json()["report"]["manifold"] == true) job.row("manifold", "yes, compatibly oriented");
  }
  if (options.triangulate && !mesh.is_triangles()) {
    const std::size_t before = mesh.face_count();
    VKMESH_TRY(Triangulated cut, job.timed("compute", [&] { return triangulate(mesh); }));
    mesh = std::move(cut.mesh);
    if (!options.as_is) {
      // Where no diagonal was free, the triangles are repaired as any input is.
      VKMESH_TRY(const HalfEdgeMesh triangles, job.consolidate_again(mesh));
    }
    job.row("triangulated", count_of(before, "face") + " into " + count_of(mesh.face_count(), "triangle"));
  }
  job.json()["result"]["triangulated"] = options.triangulate;
  auto written = job.write(mesh, options.ascii);
  if (!written && written.error().code == ErrorCode::kUnsuitable && !options.triangulate &&
      !mesh.is_triangles())
    written.error().message += "; --triangulate cuts them";
  return written;
}

}  // namespace

void add_convert(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("convert", "Converts between file formats");
  command->footer(
      "The extension of OUT names its format. Attributes that the format cannot hold are left out, and "
      "named.\n"
      "What is no oriented manifold is repaired, and what was done is told: degenerate and duplicate faces "
      "go, "
      "faces are turned\nto agree, edges of three or more faces and points where separate fans meet are "
      "split. "
      "No position changes but by --weld.\n\n"
      "Example:\n  vkmesh convert data/dragon/dragon_vrip.ply.gz dragon.obj --weld 0.001%");
  add_common_options(*command, program.options, true, true);
  add_consolidate_options(*command, program.options);
  const auto options = std::make_shared<ConvertOptions>();
  command->add_flag("--triangulate", options->triangulate,
                    "Cut polygons into triangles (STL and glTF hold only these)");
  command->add_flag("--as-is", options->as_is, "Judge and repair nothing: defects pass through");
  command->add_flag("--ascii", options->ascii,
                    "Write text where the format has a binary form as well (PLY, STL)");
  command->callback([&program, options] {
    program.command = "convert";
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
