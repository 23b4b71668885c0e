// Quadrics and collapse costs on a device.
#pragma once

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/collapse_costs.h>

namespace vkmesh {

/// Results of record_collapse_costs(), kept by the caller for as long as it likes.
struct DeviceCollapseCosts {
  DeviceArray<VertexQuadric> quadrics;  ///< One a vertex.
  DeviceArray<float> costs;             ///< One a half-edge.
};

/// Records the passes of which vkmesh::vertex_quadrics() and vkmesh::collapse_costs() are the references,
/// equal to them bit for bit. O(half-edges). Errors: kUsage for options out of range; as
/// DeviceMesh::corner_offsets().
[[nodiscard]] VKMESH_API Result<void> record_collapse_costs(Recorder& recorder, DeviceMesh& mesh,
                                                            DeviceCollapseCosts& result,
                                                            const CollapseCostOptions& options);

}  // namespace vkmesh
