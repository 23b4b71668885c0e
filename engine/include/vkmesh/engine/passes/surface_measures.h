// Area, volume, centroid and bounds on a device.
#pragma once

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/surface_measures.h>

namespace vkmesh {

/// Records the pass of which vkmesh::surface_measures() is the reference, equal to it bit for bit; the result
/// is read by DeviceMesh::download_surface_measures(). O(faces). Errors: kUsage unless the mesh was made for
/// this pass.
[[nodiscard]] Result<void> record_surface_measures(Recorder& recorder, DeviceMesh& mesh);

}  // namespace vkmesh
