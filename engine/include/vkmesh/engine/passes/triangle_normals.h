// Triangle normals on a device.
#pragma once

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/triangle_normals.h>

namespace vkmesh {

/// Records the pass of which vkmesh::triangle_normals() is the reference, equal to it bit for bit: one vector
/// a face. O(faces). Errors: kOutOfMemory, kNoDevice.
[[nodiscard]] VKMESH_API Result<void> record_triangle_normals(Recorder& recorder, DeviceMesh& mesh,
                                                              DeviceArray<Vec3>& normals);

}  // namespace vkmesh
