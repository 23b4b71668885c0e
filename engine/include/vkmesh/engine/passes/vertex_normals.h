// Vertex normals on a device.
#pragma once

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/vertex_normals.h>

namespace vkmesh {

/// Result and scratch of record_vertex_normals(), kept by the caller for as long as it likes.
struct DeviceVertexNormals {
  DeviceArray<Vec3> normals;       ///< One a vertex.
  DeviceArray<Vec3> face_vectors;  ///< Scratch.
};

/// Records the pass of which vkmesh::vertex_normals() is the reference, equal to it bit for bit.
/// O(half-edges). Errors: as DeviceMesh::corner_offsets().
[[nodiscard]] VKMESH_API Result<void> record_vertex_normals(Recorder& recorder, DeviceMesh& mesh,
                                                            DeviceVertexNormals& result,
                                                            const VertexNormalsOptions& options = {});

}  // namespace vkmesh
