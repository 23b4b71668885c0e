// Dihedral angles on a device.
#pragma once

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/dihedral_angles.h>

namespace vkmesh {

/// Records the pass of which vkmesh::dihedral_angles() is the reference, equal to it bit for bit; the results
/// are read by DeviceMesh::download_half_edge_angles() and download_vertex_maxima(). O(half-edges). Errors:
/// kUsage unless the mesh was made for this pass.
[[nodiscard]] Result<void> record_dihedral_angles(Recorder& recorder, DeviceMesh& mesh);

}  // namespace vkmesh
