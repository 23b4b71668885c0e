#include <span>
#include <variant>
#include <vector>

#include <vkmesh/mesh/memory.h>

namespace vkmesh {
namespace {

template <class... Arrays>
std::size_t bytes(const Arrays&... arrays) {
  return (std::size_t{0} + ... + (arrays.size() * sizeof(arrays[0])));
}

std::size_t bytes_of(const std::vector<Channel>& channels) {
  std::size_t sum = 0;
  for (const Channel& channel : channels)
    sum += std::visit([](const auto& values) { return bytes(values); }, channel.values);
  return sum;
}

}  // namespace

std::size_t bytes_of(const PolygonSoup& soup) {
  return bytes(soup.corners, soup.face_offsets) + bytes_of(soup.face_channels);
}

std::size_t bytes_of(const IndexedFaceSet& mesh) {
  return bytes(mesh.points, mesh.corners, mesh.face_offsets) + bytes_of(mesh.point_channels) +
         bytes_of(mesh.corner_channels) + bytes_of(mesh.face_channels);
}

std::size_t bytes_of(const HalfEdgeMesh& mesh) {
  return bytes(mesh.origins(), mesh.twins(), mesh.leadings(), mesh.face_offsets(), mesh.faces());
}

std::size_t bytes_of(const TriangleNeighbours& triangles) {
  return bytes(triangles.corners, triangles.neighbours, triangles.leading);
}

std::size_t bytes_of(const NodeNeighbours& neighbours) {
  return bytes(neighbours.offsets, neighbours.ids, neighbours.boundary_bits);
}

std::size_t bytes_of(const VertexCorners& corners) {
  return bytes(corners.offsets, corners.half_edges);
}

}  // namespace vkmesh
