// Area, volume, centroid and bounds on a device.
#pragma once

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/surface_measures.h>

namespace vkmesh {

/// Result and scratch of record_surface_measures(), kept by the caller for as long as it likes.
struct VKMESH_API DeviceSurfaceMeasures {
  DeviceArray<RawMeasures> raw;                    ///< One.
  DeviceArray<float> block_sums, more_block_sums;  ///< Scratch.

  /// The measures, once the work has run. Errors: kOutOfMemory, kNoDevice.
  [[nodiscard]] Result<SurfaceMeasures> download() const;
};

/// Records the pass of which vkmesh::surface_measures() is the reference, equal to it bit for bit. O(faces).
/// Errors: kOutOfMemory, kNoDevice.
[[nodiscard]] VKMESH_API Result<void> record_surface_measures(Recorder& recorder, DeviceMesh& mesh,
                                                              DeviceSurfaceMeasures& result);

}  // namespace vkmesh
