// What each structure holds in memory.
#pragma once

#include <cstddef>

#include <vkmesh/base/api.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/indexed_face_set.h>
#include <vkmesh/mesh/node_neighbours.h>
#include <vkmesh/mesh/polygon_soup.h>
#include <vkmesh/mesh/triangle_neighbours.h>
#include <vkmesh/mesh/vertex_corners.h>

namespace vkmesh {

// Bytes of the elements, without what allocators add; docs/structures.md has them per element. O(1), but
// O(channels) where there are some.
[[nodiscard]] VKMESH_API std::size_t bytes_of(const PolygonSoup& soup);
[[nodiscard]] VKMESH_API std::size_t bytes_of(const IndexedFaceSet& mesh);
[[nodiscard]] VKMESH_API std::size_t bytes_of(const HalfEdgeMesh& mesh);
[[nodiscard]] VKMESH_API std::size_t bytes_of(const TriangleNeighbours& triangles);
[[nodiscard]] VKMESH_API std::size_t bytes_of(const NodeNeighbours& neighbours);
[[nodiscard]] VKMESH_API std::size_t bytes_of(const VertexCorners& corners);

}  // namespace vkmesh
