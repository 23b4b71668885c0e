// The least an engine does to run a pass: vertex normals of a mesh file, on any Vulkan device.
//   embed IN [DEVICE]      DEVICE as in ContextOptions::device; default auto
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/engine/passes/vertex_normals.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/repair/consolidate.h>

using namespace vkmesh;

// [readme]
Result<std::vector<Vec3>> normals_of(const char* path, const ContextOptions& options) {
  VKMESH_TRY(MeshFile file, read_mesh(path));
  VKMESH_TRY(IndexedFaceSet mesh, to_indexed_face_set(std::move(file)));
  VKMESH_TRY(Consolidated made, consolidate(std::move(mesh)));
  VKMESH_TRY(auto context, Context::create(options));
  VKMESH_TRY(auto device, DeviceMesh::create(*context, made.mesh, made.face_set.points));
  DeviceVertexNormals result;
  VKMESH_TRY(auto recorder, Recorder::create(*context));
  VKMESH_CHECK(record_vertex_normals(recorder, device, result));
  VKMESH_CHECK(recorder.submit_and_wait());
  return result.normals.download();
}
// [readme]

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: embed IN [DEVICE]\n"), 2;
  ContextOptions options;
  if (argc > 2) options.device = argv[2];
  const auto normals = normals_of(argv[1], options);
  if (!normals) {
    std::fprintf(stderr, "embed: %s\n", normals.error().describe().c_str());
    return static_cast<int>(normals.error().code);
  }
  std::printf("%zu normals\n", normals->size());
  return 0;
}
