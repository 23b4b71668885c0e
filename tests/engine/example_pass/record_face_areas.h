// The area of every triangle on a device.
#pragma once

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>

namespace vkmesh {

/// Records the pass of which vkmesh::face_areas() is the reference, equal to it bit for bit: one value a
/// face. O(faces). Errors: kOutOfMemory, kNoDevice.
[[nodiscard]] Result<void> record_face_areas(Recorder& recorder, DeviceMesh& mesh, DeviceArray<float>& areas);

}  // namespace vkmesh
