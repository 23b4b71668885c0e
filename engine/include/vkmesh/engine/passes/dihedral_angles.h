// Dihedral angles on a device.
#pragma once

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/dihedral_angles.h>

namespace vkmesh {

/// Results and scratch of record_dihedral_angles(), kept by the caller for as long as it likes.
struct DeviceDihedralAngles {
  DeviceArray<float> half_edge;       ///< As DihedralAngles::half_edge.
  DeviceArray<float> vertex_maximum;  ///< As DihedralAngles::vertex_maximum.
  DeviceArray<Vec3> normals;          ///< Scratch.
};

/// Records the pass of which vkmesh::dihedral_angles() is the reference, equal to it bit for bit.
/// O(half-edges). Errors: as DeviceMesh::corner_offsets().
[[nodiscard]] VKMESH_API Result<void> record_dihedral_angles(Recorder& recorder, DeviceMesh& mesh,
                                                             DeviceDihedralAngles& result);

}  // namespace vkmesh
