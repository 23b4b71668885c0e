// Scores of edge swaps on a device.
#pragma once

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/swap_scores.h>

namespace vkmesh {

/// Records the pass of which vkmesh::swap_scores() is the reference, equal to it bit for bit: one score a
/// half-edge. O(half-edges). Errors: kOutOfMemory, kNoDevice.
[[nodiscard]] VKMESH_API Result<void> record_swap_scores(Recorder& recorder, DeviceMesh& mesh,
                                                         DeviceArray<float>& scores,
                                                         SwapCriterion criterion = SwapCriterion::kMinAngle);

}  // namespace vkmesh
