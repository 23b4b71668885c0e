// Giving a surface back its volume on a device.
#pragma once

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/restore_volume.h>

namespace vkmesh {

/// Measures the volume that the mesh's positions enclose, for record_restore_volume() later in the same work.
/// Errors: kUnsuitable unless the mesh is closed; kUsage unless it was made for the pass restore_volume.
[[nodiscard]] Result<void> record_volume(Recorder& recorder, DeviceMesh& mesh);

/// Records the pass of which vkmesh::restore_volume() is the reference, equal to it bit for bit: the volume
/// is that which record_volume() measured last. O(faces). Errors: as record_volume().
[[nodiscard]] Result<void> record_restore_volume(Recorder& recorder, DeviceMesh& mesh);

}  // namespace vkmesh
