// Quadrics and collapse costs on a device.
#pragma once

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/collapse_costs.h>

namespace vkmesh {

/// Records the passes of which vkmesh::quadrics() and vkmesh::collapse_costs() are the references, equal to
/// them bit for bit; the results are read by DeviceMesh::download_quadrics() and download_collapse_costs().
/// O(half-edges). Errors: kUsage unless the mesh was made for this pass, and for options out of range.
[[nodiscard]] Result<void> record_collapse_costs(Recorder& recorder, DeviceMesh& mesh,
                                                 const CollapseCostOptions& options);

}  // namespace vkmesh
