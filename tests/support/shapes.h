// Small meshes with known answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/indexed_face_set.h>

namespace vkmesh::test {

IndexedFaceSet tetrahedron();
/// Unit cube [0, 1]³: 8 points, 12 triangles.
IndexedFaceSet cube();
/// The same with six quads.
IndexedFaceSet quad_cube();
/// The same with n × n quads a side, each cut into two triangles: 6 n² + 2 points, 12 n² triangles.
IndexedFaceSet fine_cube(int n);
/// Unit sphere from the icosahedron, each triangle split 1:4 `level` times: 10·4^level + 2 points, 20·4^level
/// faces.
IndexedFaceSet icosphere(unsigned level, float radius = 1.0f);
/// Closed torus of rings × sides quads, each cut into two triangles.
IndexedFaceSet torus(std::uint32_t rings, std::uint32_t sides, float major = 1.0f, float minor = 0.4f);
/// Flat grid in the plane z = 0 over [0, nx] × [0, ny]: (nx+1)(ny+1) points, 2 nx ny triangles, one boundary
/// loop.
IndexedFaceSet grid(std::uint32_t nx, std::uint32_t ny);
/// A band of n quads cut into triangles, closed with half a turn: manifold, not orientable, one boundary
/// loop.
IndexedFaceSet mobius(std::uint32_t n);
/// Open tube of rings × sides quads cut into triangles: two boundary loops.
IndexedFaceSet cylinder(std::uint32_t rings, std::uint32_t sides);
/// A torus whose tube is mirrored once on its way round: closed, not orientable.
IndexedFaceSet klein_bottle(std::uint32_t rings, std::uint32_t sides);
/// Two tori, a triangle of each taken out and the holes joined: genus 2.
IndexedFaceSet double_torus();
/// Two tori that have one point in common.
IndexedFaceSet tori_sharing_a_point();
/// The faces of both, the points of `b` moved by `offset`.
IndexedFaceSet both(const IndexedFaceSet& a, const IndexedFaceSet& b, Vec3 offset = Vec3(0.0f));
/// Two tetrahedra that share one point: a non-manifold vertex.
IndexedFaceSet bow_tie();
/// Three triangles on one edge.
IndexedFaceSet fin();

/// By name: spheres, grids and tori with points that coincide, that lie in a line, in a plane, very near and
/// very far; each has a point that is in no face.
std::map<std::string, IndexedFaceSet> degenerate_shapes();

/// Moves every coordinate by a pseudo-random amount of at most `amplitude`; the same seed gives the same
/// mesh.
void jitter(IndexedFaceSet& mesh, float amplitude, std::uint32_t seed);

/// A sphere, a torus, a grid, a cylinder and a cube, each jittered by 0.02.
std::vector<IndexedFaceSet> noisy_shapes();

/// to_half_edge_mesh() of a mesh that is known to be manifold; fails the test otherwise.
HalfEdgeMesh half_edges(const IndexedFaceSet& mesh);

}  // namespace vkmesh::test
