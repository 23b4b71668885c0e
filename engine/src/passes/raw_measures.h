// The sums behind area, volume, centroid and bounds, on a device.
#pragma once

#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>

namespace vkmesh::detail {

/// Records the computation of RawMeasures into `measures`.
[[nodiscard]] Result<void> record_raw_measures(Recorder& recorder, const DeviceMesh& mesh,
                                               const Buffer& measures);

}  // namespace vkmesh::detail
