// Laplacian smoothing on a device.
#pragma once

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/laplacian_smoothing.h>

namespace vkmesh {

/// Records the pass of which vkmesh::laplacian_smoothing() is the reference, equal to it bit for bit; the
/// result takes the place of the mesh's positions. All iterations are one submission. O(iterations × edges).
/// Errors: kUsage unless the mesh was made for this pass, for λ outside [0, 1], μ outside [−1, 0], and for
/// locked vertices, which DeviceMesh::upload_locks() takes.
[[nodiscard]] Result<void> record_laplacian_smoothing(Recorder& recorder, DeviceMesh& mesh,
                                                      const LaplacianSmoothingOptions& options = {});

}  // namespace vkmesh
