// Bilateral smoothing on a device.
#pragma once

#include <cstdint>
#include <span>

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/buffer.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/bilateral_smoothing.h>

namespace vkmesh {

/// For each vertex the faces that lie near it, found by the host for given positions and widths; in device
/// memory, with room for what the pass computes of them on the way.
class NearbyFaces {
 public:
  /// O(n log n). Errors: as bilateral_smoothing(); kUnsuitable where more faces than DeviceInfo::loop_rounds
  /// lie near a vertex; kOutOfMemory; kNoDevice.
  [[nodiscard]] static Result<NearbyFaces> create(Context& context, const HalfEdgeMesh& mesh,
                                                  std::span<const Vec3> positions,
                                                  const BilateralSmoothingOptions& options);

  /// The faces, of which the mesh must have as many, and the vertices that they meet.
  [[nodiscard]] std::uint32_t face_count() const { return faces_; }
  [[nodiscard]] std::uint32_t vertex_count() const { return vertices_; }

 private:
  friend Result<void> record_bilateral_smoothing(Recorder& recorder, DeviceMesh& mesh,
                                                 const NearbyFaces& nearby);
  /// The faces in cells at most one or two away from each cell of vertices, as ranges of places.
  struct Ranges {
    Buffer offsets, ends;
  };

  BilateralSmoothingOptions options_;
  std::uint32_t faces_ = 0, vertices_ = 0, vertices_of_mesh_ = 0;
  Buffer face_order_, vertex_order_, cells_, centroids_and_areas_, normals_, mollified_;
  Ranges near_, far_;
};

/// Records the pass of which vkmesh::bilateral_smoothing() is the reference, equal to it bit for bit where
/// the mesh's positions, when the work runs, are those that `nearby` was made of; the result takes their
/// place. O(vertices × faces within some 3 σ_f). Errors: kUsage unless the mesh was made for this pass and
/// `nearby` for this mesh.
[[nodiscard]] Result<void> record_bilateral_smoothing(Recorder& recorder, DeviceMesh& mesh,
                                                      const NearbyFaces& nearby);

}  // namespace vkmesh
