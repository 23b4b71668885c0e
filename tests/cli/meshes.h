// Small files with known answers, as text.
#pragma once

#include <string>

#include <vkmesh/mesh/indexed_face_set.h>

namespace vkmesh::test {

inline const std::string kTetrahedronOff =
    "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

/// Unit cube of six quads.
inline const std::string kCubeOff =
    "OFF\n8 6 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n"
    "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";

/// Three triangles on one edge.
inline const std::string kFinOff =
    "OFF\n5 3 0\n0 0 0\n1 0 0\n0.5 1 0\n0.5 -1 0\n0.5 0 1\n3 0 1 2\n3 1 0 3\n3 0 1 4\n";

/// OBJ text of an octahedron of whose faces each has texture coordinates of its own: every edge is a seam.
inline std::string octahedron_of_seams() {
  std::string text;
  for (const char* v : {"2 0 0", "-2 0 0", "0 2 0", "0 -2 0", "0 0 2", "0 0 -2"})
    text += std::string("v ") + v + "\n";
  for (int i = 0; i < 24; ++i) text += "vt " + std::to_string(i % 5) + " " + std::to_string(i) + "\n";
  const int faces[8][3] = {{1, 3, 5}, {3, 2, 5}, {2, 4, 5}, {4, 1, 5},
                           {3, 1, 6}, {2, 3, 6}, {4, 2, 6}, {1, 4, 6}};
  for (int f = 0; f < 8; ++f) {
    text += "f";
    for (int k = 0; k < 3; ++k)
      text += " " + std::to_string(faces[f][k]) + "/" + std::to_string(3 * f + k + 1);
    text += "\n";
  }
  return text;
}

/// The mesh as OFF text, written here and not by the library.
inline std::string off_of(const IndexedFaceSet& mesh) {
  std::string text =
      "OFF\n" + std::to_string(mesh.points.size()) + " " + std::to_string(mesh.face_count()) + " 0\n";
  for (const Vec3& p : mesh.points)
    text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    text += std::to_string(mesh.face(f).size());
    for (const std::uint32_t corner : mesh.face(f)) text += " " + std::to_string(corner);
    text += "\n";
  }
  return text;
}

}  // namespace vkmesh::test
