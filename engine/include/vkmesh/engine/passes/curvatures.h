// Mean and Gaussian curvature on a device.
#pragma once

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/curvatures.h>

namespace vkmesh {

/// Records the pass of which vkmesh::curvatures() is the reference, equal to it bit for bit: one value a
/// vertex. O(edges). Errors: as DeviceMesh::neighbour_offsets().
[[nodiscard]] VKMESH_API Result<void> record_curvatures(Recorder& recorder, DeviceMesh& mesh,
                                                        DeviceArray<VertexCurvature>& curvatures);

}  // namespace vkmesh
