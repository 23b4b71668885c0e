// The whole way of a mesh: file, half-edges, compute passes on a Vulkan device, simplification on the host,
// files.
//   main_job IN OUT-FOLDER [DEVICE]      DEVICE as in ContextOptions::device; default auto
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/engine/passes/dihedral_angles.h>
#include <vkmesh/engine/passes/laplacian_smoothing.h>
#include <vkmesh/engine/passes/vertex_normals.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/repair/consolidate.h>

using namespace vkmesh;

namespace {

using Clock = std::chrono::steady_clock;

std::string grouped(std::size_t n, const char* of) {
  std::string text = std::to_string(n);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, 1, ',');
  return text + " " + of;
}

void row(const char* step, const std::string& counts, double ms, const std::string& device) {
  std::printf("%-12s %-46s %7.0f ms  %s\n", step, counts.c_str(), ms, device.c_str());
  std::fflush(stdout);
}

/// Milliseconds since `from`, which becomes now.
double lap(Clock::time_point& from) {
  const auto now = Clock::now();
  return std::chrono::duration<double, std::milli>(now - std::exchange(from, now)).count();
}

Result<void> run(const std::filesystem::path& in, const std::filesystem::path& out,
                 const std::string& device) {
  auto start = Clock::now(), from = start;
  VKMESH_TRY(MeshFile file, read_mesh(in));
  VKMESH_TRY(IndexedFaceSet mesh, to_indexed_face_set(std::move(file)));
  const std::string points = grouped(mesh.points.size(), "points");
  row("read", points + ", " + grouped(mesh.face_count(), "faces"), lap(from), "host");

  VKMESH_TRY(Consolidated c, consolidate(std::move(mesh)));
  mesh = std::move(c.face_set);
  const std::string boundary = grouped(c.report.boundary_edges, "on the boundary");
  row("consolidate", grouped(c.report.edges, "edges, ") + boundary, lap(from), "host");

  ContextOptions options;
  options.device = device;
  VKMESH_TRY(const auto context, Context::create(options));
  const std::string& name = context->info().name;
  row("open", "the device", lap(from), name);
  VKMESH_TRY(DeviceMesh on_device, DeviceMesh::create(*context, c.mesh, mesh.points));
  DeviceSmoothing smoothing;
  DeviceVertexNormals device_normals;
  DeviceDihedralAngles device_angles;

  VKMESH_TRY(Recorder recorder, Recorder::create(*context));
  recorder.begin_section("smooth");
  VKMESH_CHECK(
      record_laplacian_smoothing(recorder, on_device, smoothing, {.lambda = 0.5f, .iterations = 10}));
  recorder.begin_section("normals");
  VKMESH_CHECK(record_vertex_normals(recorder, on_device, device_normals));
  recorder.begin_section("curvature");
  VKMESH_CHECK(record_dihedral_angles(recorder, on_device, device_angles));
  row("upload", grouped(context->allocated_bytes() >> 20, "MiB on the device"), lap(from), name);
  VKMESH_CHECK(recorder.submit_and_wait());
  for (const SectionTime& section : recorder.section_times())
    row(section.name.c_str(), points + (section.name == "smooth" ? ", 10 steps" : ""), section.milliseconds,
        name);

  lap(from);
  VKMESH_TRY(mesh.points, on_device.positions().download());
  VKMESH_TRY(const std::vector<Vec3> normals, device_normals.normals.download());
  VKMESH_TRY(const std::vector<float> angles, device_angles.vertex_maximum.download());
  row("download", "positions, normals, angles", lap(from), name);

  DecimateOptions decimation;
  decimation.target.faces = c.mesh.face_count() / 10;
  VKMESH_TRY(const Decimated small, decimate(c.mesh, mesh.points, decimation));
  VKMESH_CHECK(validate(small.mesh));
  row("simplify", grouped(small.mesh.face_count(), "faces; ") + name_of(small.stop), lap(from), "host");

  IndexedFaceSet simplified;
  simplified.points = small.positions;
  simplified.corners.assign(small.mesh.origins().begin(), small.mesh.origins().end());
  std::vector<float> all_normals, few_normals, few_angles;
  for (const Vec3& n : normals) all_normals.insert(all_normals.end(), {n.x, n.y, n.z});
  for (const std::uint32_t v : small.source_vertex) {
    few_normals.insert(few_normals.end(), {normals[v].x, normals[v].y, normals[v].z});
    few_angles.push_back(angles[v]);
  }
  mesh.point_channels = {{"normal", 3, std::move(all_normals)}, {"quality", 1, angles}};
  simplified.point_channels = {{"normal", 3, std::move(few_normals)}, {"quality", 1, std::move(few_angles)}};
  std::error_code ignored;  // A folder that could not be made fails the writing.
  std::filesystem::create_directories(out, ignored);
  VKMESH_CHECK(write_mesh(out / "smooth.ply", mesh, {}));
  VKMESH_CHECK(write_mesh(out / "simplified.ply", simplified, {}));
  row("write", "smooth.ply, simplified.ply", lap(from), "host");
  row("all of it", "", lap(start), "");
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: main_job IN OUT-FOLDER [DEVICE]\n"), 2;
  const Result<void> done = run(argv[1], argv[2], argc > 3 ? argv[3] : "auto");
  if (!done) std::fprintf(stderr, "main_job: %s\n", done.error().describe().c_str());
  return done ? 0 : static_cast<int>(done.error().code);
}
