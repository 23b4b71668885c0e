// Vectors and triangles in double precision, for the formulas that results are held against.
#pragma once

#include <cmath>
#include <cstddef>

#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/indexed_face_set.h>

namespace vkmesh::test {

inline DVec3 cross(DVec3 a, DVec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double dot(DVec3 a, DVec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline double length(DVec3 a) {
  return std::sqrt(dot(a, a));
}
/// Twice the area of triangle f, along its normal.
inline DVec3 area_of(const IndexedFaceSet& mesh, std::size_t f) {
  const auto c = mesh.face(f);
  const DVec3 p(mesh.points[c[0]]), q(mesh.points[c[1]]), r(mesh.points[c[2]]);
  return cross(q - p, r - p);
}
/// The angle of triangle f at its corner i.
inline double angle_of(const IndexedFaceSet& mesh, std::size_t f, std::size_t i) {
  const auto c = mesh.face(f);
  const DVec3 p(mesh.points[c[i]]), a = DVec3(mesh.points[c[(i + 1) % 3]]) - p,
                                    b = DVec3(mesh.points[c[(i + 2) % 3]]) - p;
  return std::acos(dot(a, b) / (length(a) * length(b)));
}

}  // namespace vkmesh::test
