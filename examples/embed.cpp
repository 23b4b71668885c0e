// The least an engine does to run a pass: vertex normals of a mesh file, on any Vulkan device.
//   embed IN [DEVICE]
#include <cstdio>
#include <string>
#include <vector>

#include <vkmesh/consolidate.h>
#include <vkmesh/engine/vertex_normals.h>
#include <vkmesh/io/mesh_io.h>

// [readme]
vkmesh::Result<std::vector<vkmesh::Vec3>> normals_of(const char* path, const std::string& device) {
  VKMESH_TRY(vkmesh::MeshFile file, vkmesh::read_mesh(path));
  VKMESH_TRY(auto mesh, vkmesh::to_indexed_face_set(std::move(file)));
  VKMESH_TRY(auto half_edges, vkmesh::consolidate(mesh));
  vkmesh::ContextOptions options;
  options.device = device;
  VKMESH_TRY(auto context, vkmesh::Context::create(options));
  VKMESH_TRY(auto on_device,
             vkmesh::DeviceMesh::create(*context, half_edges.mesh, mesh.points, {.vertex_normals = true}));
  VKMESH_TRY(auto recorder, vkmesh::Recorder::create(*context));
  VKMESH_CHECK(vkmesh::record_vertex_normals(recorder, on_device));
  VKMESH_CHECK(recorder.submit_and_wait());
  return on_device.download_vertex_normals();
}
// [readme]

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: embed IN [DEVICE]\n"), 2;
  const auto normals = normals_of(argv[1], argc > 2 ? argv[2] : "auto");
  if (!normals) {
    std::fprintf(stderr, "embed: %s\n", normals.error().describe().c_str());
    return static_cast<int>(normals.error().code);
  }
  std::printf("%zu normals\n", normals->size());
  return 0;
}
