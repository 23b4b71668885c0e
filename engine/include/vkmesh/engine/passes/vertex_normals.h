// Vertex normals on a device.
#pragma once

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/vertex_normals.h>

namespace vkmesh {

/// Records the pass of which vkmesh::vertex_normals() is the reference, equal to it bit for bit; the result
/// is read by DeviceMesh::download_vertex_normals(). O(half-edges). Errors: kUsage unless the mesh was made
/// for this pass.
[[nodiscard]] Result<void> record_vertex_normals(Recorder& recorder, DeviceMesh& mesh,
                                                 const VertexNormalsOptions& options = {});

}  // namespace vkmesh
