// Bilateral smoothing on a device.
#pragma once

#include <cstdint>
#include <span>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/bilateral_smoothing.h>

namespace vkmesh {

/// The faces that lie near each vertex, found by the host for given positions and widths, in device memory;
/// and the scratch of record_bilateral_smoothing().
struct VKMESH_API NearbyFaces {
  /// O(n log n). Errors: as bilateral_smoothing(); kUnsuitable where more faces than DeviceInfo::loop_rounds
  /// lie near a vertex; kOutOfMemory; kNoDevice.
  [[nodiscard]] static Result<NearbyFaces> create(Context& context, const HalfEdgeMesh& mesh,
                                                  std::span<const Vec3> positions,
                                                  const BilateralSmoothingOptions& options);

  /// Ranges of places in `face_order`: cell c's are those from offsets[c] to offsets[c + 1], two places each.
  struct Ranges {
    DeviceArray<std::uint32_t> offsets, ends;
  };

  BilateralSmoothingOptions options;
  std::uint32_t mesh_vertices = 0;
  DeviceArray<std::uint32_t> face_order;    ///< The face at each place of the grid.
  DeviceArray<std::uint32_t> vertex_order;  ///< The vertex at each place; only those that faces meet.
  DeviceArray<std::uint32_t> cells;         ///< The cell of each of these.
  Ranges near, far;                         ///< Faces in cells at most one, and at most two, cells away.

  DeviceArray<float> centroids_and_areas;  ///< Scratch.
  DeviceArray<Vec3> normals, mollified;    ///< Scratch.
};

/// Records the pass of which vkmesh::bilateral_smoothing() is the reference, equal to it bit for bit where
/// the mesh's positions, when the work runs, are those that `nearby` was made of; the result takes their
/// place. O(vertices × faces within some 3 σ_f). Errors: kUsage unless `nearby` was made for this mesh;
/// kOutOfMemory, kNoDevice.
[[nodiscard]] VKMESH_API Result<void> record_bilateral_smoothing(Recorder& recorder, DeviceMesh& mesh,
                                                                 NearbyFaces& nearby);

}  // namespace vkmesh
