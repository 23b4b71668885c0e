// Giving a surface back its volume on a device.
#pragma once

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/engine/passes/surface_measures.h>
#include <vkmesh/passes/restore_volume.h>

namespace vkmesh {

/// Records the pass of which vkmesh::restore_volume() is the reference, equal to it bit for bit: the mesh's
/// positions enclose the volume again that record_surface_measures() measured as `before`. Measures them as
/// `after` on the way. O(faces). Errors: kUnsuitable unless the mesh is closed; as record_surface_measures().
[[nodiscard]] VKMESH_API Result<void> record_restore_volume(Recorder& recorder, DeviceMesh& mesh,
                                                            const DeviceSurfaceMeasures& before,
                                                            DeviceSurfaceMeasures& after);

}  // namespace vkmesh
