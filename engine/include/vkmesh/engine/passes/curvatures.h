// Mean and Gaussian curvature on a device.
#pragma once

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/curvatures.h>

namespace vkmesh {

/// Records the pass of which vkmesh::curvatures() is the reference, equal to it bit for bit; the result is
/// read by DeviceMesh::download_curvatures(). O(edges). Errors: kUsage unless the mesh was made for this
/// pass.
[[nodiscard]] Result<void> record_curvatures(Recorder& recorder, DeviceMesh& mesh);

}  // namespace vkmesh
