// OpenMesh: its triangle mesh of default traits, and the tools that come with it.
#include <memory>

// Before the mesh: the reader of files is told of mesh types by it.
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <OpenMesh/Tools/Smoother/JacobiLaplaceSmootherT.hh>

#include "bench/contestants.h"

namespace vkmesh::bench {
namespace {

using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;

std::unique_ptr<Mesh> build(const IndexedFaceSet& input) {
  auto mesh = std::make_unique<Mesh>();
  const std::size_t faces = input.face_count();
  mesh->reserve(input.points.size(), faces + faces / 2, faces);
  for (const Vec3& p : input.points) mesh->add_vertex(Mesh::Point(p.x, p.y, p.z));
  for (std::size_t f = 0; f < faces; ++f) {
    const auto corner = [&](std::size_t i) {
      return Mesh::VertexHandle(static_cast<int>(input.corners[3 * f + i]));
    };
    mesh->add_face(corner(0), corner(1), corner(2));
  }
  return mesh;
}

Surface surface_of(const Mesh& mesh) {
  Surface surface;
  for (const auto v : mesh.vertices()) {
    const Mesh::Point& p = mesh.point(v);
    surface.points.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : mesh.faces())
    for (const auto v : mesh.fv_range(f)) surface.corners.push_back(static_cast<std::uint32_t>(v.idx()));
  return surface;
}

}  // namespace

void add_openmesh(Programme& programme, const Input& input, const ReadingFiles& files) {
  const std::string name = "OpenMesh";
  programme.libraries.push_back({name, std::to_string(OM_GET_VER) + "." + std::to_string(OM_GET_MAJ)});
  const std::shared_ptr<Mesh> mesh = build(input.mesh);

  for (const ReadingFiles::File& file : files.all())
    programme.contestants.push_back(
        {file.step,
         name,
         [&file]() -> Result<double> {
           Mesh read;
           const Stopwatch watch;
           if (!OpenMesh::IO::read_mesh(read, file.path.string()))
             return fail(ErrorCode::kUnreadable, "OpenMesh cannot read it", {file.path.string(), {}, {}});
           return watch.milliseconds();
         },
         {},
         false,
         file.size});
  programme.contestants.push_back({step::kConstruction, name, [&input]() -> Result<double> {
                                     const Stopwatch watch;
                                     const auto built = build(input.mesh);
                                     return watch.milliseconds();
                                   }});
  programme.contestants.push_back({step::kNormals, name, [mesh]() -> Result<double> {
                                     mesh->request_face_normals();
                                     mesh->request_vertex_normals();
                                     const Stopwatch watch;
                                     mesh->update_normals();
                                     const double milliseconds = watch.milliseconds();
                                     mesh->release_vertex_normals();
                                     mesh->release_face_normals();
                                     return milliseconds;
                                   }});
  programme.contestants.push_back({step::kSmoothing, name, [mesh]() -> Result<double> {
                                     Mesh copy = *mesh;
                                     OpenMesh::Smoother::JacobiLaplaceSmootherT<Mesh> smoother(copy);
                                     using Base = OpenMesh::Smoother::SmootherT<Mesh>;
                                     smoother.initialize(Base::Tangential_and_Normal, Base::C0);
                                     const Stopwatch watch;
                                     smoother.smooth(kSmoothingSteps);
                                     return watch.milliseconds();
                                   }});
  for (const DecimationCase& wanted : decimation_cases(input)) {
    if (wanted.shuffled) continue;  // its order is nothing to this, and a row takes long
    add_decimation(
        programme, wanted, name,
        [mesh, target = wanted.target](Surface& surface) -> Result<double> {
          Mesh copy = *mesh;
          const Stopwatch watch;
          OpenMesh::Decimater::DecimaterT<Mesh> decimater(copy);
          OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
          decimater.add(quadric);
          decimater.module(quadric).unset_max_err();
          decimater.initialize();
          decimater.decimate_to_faces(0, target);
          copy.garbage_collection();
          const double milliseconds = watch.milliseconds();
          surface = surface_of(copy);
          return milliseconds;
        },
        true);
  }
}

}  // namespace vkmesh::bench
