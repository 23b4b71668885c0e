// Laplacian smoothing on a device.
#pragma once

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/laplacian_smoothing.h>

namespace vkmesh {

/// Locks and scratch of record_laplacian_smoothing(), kept by the caller for as long as it likes.
struct DeviceSmoothing {
  /// Bit v % 32 of word v / 32: vertex v stays. Uploaded by the caller. Empty: none.
  DeviceArray<std::uint32_t> locked;
  DeviceArray<Vec3> positions;             ///< Scratch.
  DeviceArray<std::uint32_t> none_locked;  ///< Scratch.
};

/// Records the pass of which vkmesh::laplacian_smoothing() is the reference, equal to it bit for bit; the
/// result takes the place of the mesh's positions. All iterations are one submission. O(iterations × edges).
/// Errors: kUsage for λ outside [0, 1], μ outside [−1, 0], a wrong number of words in
/// DeviceSmoothing::locked, and for locked vertices in the options; as DeviceMesh::neighbour_offsets().
[[nodiscard]] VKMESH_API Result<void> record_laplacian_smoothing(
    Recorder& recorder, DeviceMesh& mesh, DeviceSmoothing& smoothing,
    const LaplacianSmoothingOptions& options = {});

}  // namespace vkmesh
