// A triangle mesh in device memory: positions and adjacency.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/context.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// Positions and adjacency of a HalfEdgeMesh, for passes to work on. Connectivity does not change. Adjacency
/// is uploaded when a pass asks for it first, or ahead by a call of the functions below. One thread at a
/// time.
class VKMESH_API DeviceMesh {
 public:
  /// Uploads positions. `mesh` is borrowed: it must stay where it is while passes are recorded. O(vertices).
  /// Errors: kUnsuitable unless triangles, and for a coordinate out of range (see prepare_positions());
  /// kUsage unless one position for each vertex; kOutOfMemory; kNoDevice.
  [[nodiscard]] static Result<DeviceMesh> create(Context& context, const HalfEdgeMesh& mesh,
                                                 std::span<const Vec3> positions);
  static Result<DeviceMesh> create(Context&, const HalfEdgeMesh&&, std::span<const Vec3>) = delete;

  [[nodiscard]] std::uint32_t vertex_count() const { return vertices_; }
  [[nodiscard]] std::uint32_t face_count() const { return faces_; }
  [[nodiscard]] std::uint32_t half_edge_count() const { return 3 * faces_; }
  [[nodiscard]] bool is_closed() const { return closed_; }  ///< Has no boundary.

  /// One a vertex. Passes that move vertices write here.
  [[nodiscard]] const DeviceArray<Vec3>& positions() const { return positions_; }
  /// Replaces the positions. The device must not be using them. Errors: as create().
  [[nodiscard]] Result<void> upload_positions(std::span<const Vec3> positions);

  /// Numbers of vertices or half-edges, or bits.
  using Indices = Result<const DeviceArray<std::uint32_t>*>;

  // Adjacency, uploaded by the first call. Valid while the mesh is neither moved nor destroyed. O(half-edges)
  // then, O(1) later. Errors: kUnsuitable for a vertex of as many neighbours as DeviceInfo::loop_rounds;
  // kOutOfMemory; kNoDevice.

  [[nodiscard]] Indices corners();  ///< The vertex where each half-edge starts; three a face.
  [[nodiscard]] Indices twins();    ///< The twin of each half-edge; kInvalid on the boundary.
  [[nodiscard]] Indices leading();  ///< HalfEdgeMesh::leadings(): one a vertex.
  /// VertexCorners: the half-edges that leave vertex v, ascending, are corner_half_edges[corner_offsets[v]]
  /// and so on up to corner_offsets[v + 1].
  [[nodiscard]] Indices corner_offsets();
  [[nodiscard]] Indices corner_half_edges();
  /// NodeNeighbours: the neighbours of vertex v in cyclic order, in the same form.
  [[nodiscard]] Indices neighbour_offsets();
  [[nodiscard]] Indices neighbour_ids();
  /// Bit v % 32 of word v / 32: vertex v lies on the boundary.
  [[nodiscard]] Indices boundary_bits();

 private:
  [[nodiscard]] Result<void> upload_corners_of_vertices();
  [[nodiscard]] Result<void> upload_neighbours();

  std::shared_ptr<Context> context_;  ///< On the same device as the caller's, which may go.
  const HalfEdgeMesh* mesh_ = nullptr;
  std::uint32_t vertices_ = 0;
  std::uint32_t faces_ = 0;
  bool closed_ = false;
  DeviceArray<Vec3> positions_;
  DeviceArray<std::uint32_t> corners_, twins_, leading_, corner_offsets_, corner_half_edges_,
      neighbour_offsets_, neighbour_ids_, boundary_bits_;
};

}  // namespace vkmesh
