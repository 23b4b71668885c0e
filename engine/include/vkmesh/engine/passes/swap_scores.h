// Scores of edge swaps on a device.
#pragma once

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/swap_scores.h>

namespace vkmesh {

/// Records the pass of which vkmesh::swap_scores() is the reference, equal to it bit for bit; the result is
/// read by DeviceMesh::download_swap_scores(). O(half-edges). Errors: kUsage unless the mesh was made for
/// this pass.
[[nodiscard]] Result<void> record_swap_scores(Recorder& recorder, DeviceMesh& mesh,
                                              SwapCriterion criterion = SwapCriterion::kMinAngle);

}  // namespace vkmesh
