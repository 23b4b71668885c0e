// openmesh_counts FILE POINTS FACES ...: reads each file with OpenMesh and compares the counts; "-" stands
// for any.
#include <cstdlib>
#include <iostream>
#include <string>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

int main(int count, char** arguments) {
  int bad = 0;
  for (int i = 1; i + 2 < count; i += 3) {
    const std::string file = arguments[i], points = arguments[i + 1], faces = arguments[i + 2];
    OpenMesh::PolyMesh_ArrayKernelT<> mesh;
    const bool read = OpenMesh::IO::read_mesh(mesh, file);
    if (read && (points == "-" || std::to_string(mesh.n_vertices()) == points) &&
        (faces == "-" || std::to_string(mesh.n_faces()) == faces))
      continue;
    ++bad;
    std::cerr << "OpenMesh: " << file << ": ";
    if (read)
      std::cerr << mesh.n_vertices() << " points and " << mesh.n_faces() << " faces, expected " << points
                << " and " << faces << "\n";
    else
      std::cerr << "not read\n";
  }
  return bad > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
