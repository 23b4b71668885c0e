// A triangle mesh in device memory.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/buffer.h>
#include <vkmesh/engine/core/context.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/node_neighbours.h>
#include <vkmesh/passes/collapse_costs.h>
#include <vkmesh/passes/curvatures.h>
#include <vkmesh/passes/surface_measures.h>

namespace vkmesh {

/// The passes that a DeviceMesh is made for: it holds what they read and write, and nothing else.
struct MeshPasses {
  bool vertex_normals = false;
  bool laplacian_smoothing = false;
  bool dihedral_angles = false;
  bool triangle_normals = false;
  bool curvatures = false;
  bool surface_measures = false;
  bool bilateral_smoothing = false;
  bool restore_volume = false;
  bool collapse_costs = false;
  bool swap_scores = false;
};

/// The arrays of a HalfEdgeMesh and the views that the passes gather over, uploaded. Connectivity does not
/// change.
class DeviceMesh {
 public:
  /// Uploads connectivity and positions. O(half-edges).
  /// Errors: kUnsuitable unless triangles, for a coordinate out of range (see prepare_positions()), and for a
  /// vertex of as many neighbours as DeviceInfo::loop_rounds;
  /// kUsage unless one position for each vertex; kOutOfMemory; kNoDevice.
  [[nodiscard]] static Result<DeviceMesh> create(Context& context, const HalfEdgeMesh& mesh,
                                                 std::span<const Vec3> positions, const MeshPasses& passes);

  /// Bytes of device memory that create() would ask for (a driver may round each of about ten buffers up).
  [[nodiscard]] static std::uint64_t estimate_memory(const HalfEdgeMesh& mesh, const MeshPasses& passes);

  [[nodiscard]] std::uint32_t vertex_count() const { return vertices_; }
  [[nodiscard]] std::uint32_t face_count() const { return faces_; }
  [[nodiscard]] bool is_closed() const { return closed_; }  ///< Has no boundary.
  [[nodiscard]] std::uint32_t half_edge_count() const { return 3 * faces_; }
  [[nodiscard]] const MeshPasses& passes() const { return passes_; }

  /// Replaces the positions. Errors: as create().
  [[nodiscard]] Result<void> upload_positions(std::span<const Vec3> positions);

  /// Replaces the vertices that smoothing leaves where they are: bit v % 32 of word v / 32. At first none.
  /// Errors: kUsage for another number of words, or for a mesh not made for smoothing; kOutOfMemory;
  /// kNoDevice.
  [[nodiscard]] Result<void> upload_locks(std::span<const std::uint32_t> locked);

  // What the device holds, once recorded work has run. Errors: kUsage for an array of a pass that the mesh
  // was not made for; kOutOfMemory; kNoDevice.
  [[nodiscard]] Result<std::vector<Vec3>> download_positions() const;
  [[nodiscard]] Result<std::vector<Vec3>> download_vertex_normals() const;
  [[nodiscard]] Result<std::vector<Vec3>> download_triangle_normals() const;
  [[nodiscard]] Result<std::vector<float>> download_half_edge_angles() const;
  [[nodiscard]] Result<std::vector<VertexCurvature>> download_curvatures() const;
  [[nodiscard]] Result<SurfaceMeasures> download_surface_measures() const;
  [[nodiscard]] Result<std::vector<float>> download_vertex_maxima() const;
  [[nodiscard]] Result<std::vector<VertexQuadric>> download_quadrics() const;
  [[nodiscard]] Result<std::vector<float>> download_collapse_costs() const;
  [[nodiscard]] Result<std::vector<float>> download_swap_scores() const;

  // The buffers, for passes; those of other passes are empty (size 0).
  [[nodiscard]] const Buffer& positions() const { return positions_; }  ///< 3 floats a vertex.
  [[nodiscard]] const Buffer& smoothed_positions() const {
    return smoothed_positions_;
  }                                                                 ///< Scratch of smoothing.
  [[nodiscard]] const Buffer& corners() const { return corners_; }  ///< Vertex of each half-edge.
  [[nodiscard]] const Buffer& twins() const { return twins_; }      ///< 1 a half-edge.
  [[nodiscard]] const Buffer& neighbour_offsets() const { return neighbour_offsets_; }  ///< Vertices + 1.
  [[nodiscard]] const Buffer& neighbour_ids() const { return neighbour_ids_; }
  [[nodiscard]] const Buffer& boundary_bits() const { return boundary_bits_; }          ///< 1 bit a vertex.
  [[nodiscard]] const Buffer& locked_bits() const { return locked_bits_; }              ///< 1 bit a vertex.
  [[nodiscard]] const Buffer& corner_offsets() const { return corner_offsets_; }        ///< Vertices + 1.
  [[nodiscard]] const Buffer& corner_half_edges() const { return corner_half_edges_; }  ///< 1 a half-edge.
  [[nodiscard]] const Buffer& face_vectors() const { return face_vectors_; }  ///< Scratch: 3 floats a face.
  [[nodiscard]] const Buffer& triangle_normals() const { return triangle_normals_; }  ///< 3 floats a face.
  [[nodiscard]] const Buffer& vertex_normals() const { return vertex_normals_; }      ///< 3 floats a vertex.
  [[nodiscard]] const Buffer& half_edge_angles() const {
    return half_edge_angles_;
  }                                                                             ///< 1 float a half-edge.
  [[nodiscard]] const Buffer& vertex_maxima() const { return vertex_maxima_; }  ///< 1 float a vertex.
  [[nodiscard]] const Buffer& curvatures() const { return curvatures_; }        ///< 4 floats a vertex.
  [[nodiscard]] const Buffer& surface_measures() const { return surface_measures_; }  ///< RawMeasures.
  [[nodiscard]] const Buffer& volume_before() const { return volume_before_; }        ///< RawMeasures.
  [[nodiscard]] const Buffer& quadrics() const { return quadrics_; }                  ///< 6 floats a vertex.
  [[nodiscard]] const Buffer& collapse_costs() const { return collapse_costs_; }  ///< 1 float a half-edge.
  [[nodiscard]] const Buffer& swap_scores() const { return swap_scores_; }        ///< 1 float a half-edge.
  // Scratch of sums over all elements.
  [[nodiscard]] const Buffer& block_sums() const { return block_sums_; }
  [[nodiscard]] const Buffer& more_block_sums() const { return more_block_sums_; }

 private:
  std::uint32_t vertices_ = 0;
  std::uint32_t faces_ = 0;
  bool closed_ = false;
  MeshPasses passes_;
  Buffer positions_, smoothed_positions_, corners_, twins_, neighbour_offsets_, neighbour_ids_,
      boundary_bits_, locked_bits_, corner_offsets_, corner_half_edges_, face_vectors_, triangle_normals_,
      vertex_normals_, half_edge_angles_, vertex_maxima_, curvatures_, surface_measures_, volume_before_,
      quadrics_, collapse_costs_, swap_scores_, block_sums_, more_block_sums_;
};

}  // namespace vkmesh
