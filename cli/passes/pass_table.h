// Every pass: how it runs on the host and on a device, what it touches, and the digest of its result. What
// `digest` and `bench` go through, and subcommands take single passes from.
#pragma once

#include <any>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#ifdef VKMESH_HAS_VULKAN
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#endif
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/node_neighbours.h>
#include <vkmesh/passes/bilateral_smoothing.h>
#include <vkmesh/passes/curvatures.h>
#include <vkmesh/passes/dihedral_angles.h>
#include <vkmesh/passes/laplacian_smoothing.h>
#include <vkmesh/passes/vertex_normals.h>

namespace vkmesh::cli {

/// What a pass is given: triangles, which must outlive this.
struct PassInput {
  PassInput(const HalfEdgeMesh& half_edges, std::span<const Vec3> points)
      : mesh(half_edges), positions(points) {}

  const HalfEdgeMesh& mesh;
  std::span<const Vec3> positions;
  /// Made by the first call.
  [[nodiscard]] Result<const NodeNeighbours*> neighbours() const;

 private:
  mutable std::optional<NodeNeighbours> neighbours_;
};

#ifdef VKMESH_HAS_VULKAN
/// A pass on a mesh in device memory, with its results and scratch.
template <class Output>
struct DevicePass {
  std::uint32_t steps = 1;
  /// Records the steps from `first` to before `end`: all of them in one go, or one portion after the other.
  std::function<Result<void>(Recorder&, std::uint32_t first, std::uint32_t end)> record;
  std::function<Result<Output>()> download;
};
#endif

/// A pass with its options.
template <class Output>
struct Pass {
  using Value = Output;
  /// Runs it on the host. The memory of `output` is used again.
  std::function<Result<void>(const PassInput&, const Progress&, Output& output)> host;
#ifdef VKMESH_HAS_VULKAN
  /// Makes it ready on a device. The mesh must outlive the result.
  std::function<Result<DevicePass<Output>>(Context&, DeviceMesh&, const PassInput&)> device;
#endif
};

[[nodiscard]] Pass<std::vector<Vec3>> vertex_normals_pass(const VertexNormalsOptions& options);
[[nodiscard]] Pass<DihedralAngles> dihedral_angles_pass();
[[nodiscard]] Pass<std::vector<VertexCurvature>> curvatures_pass();
/// With keep_volume restore_volume() follows.
[[nodiscard]] Pass<std::vector<Vec3>> laplacian_smoothing_pass(const LaplacianSmoothingOptions& options,
                                                               bool keep_volume);
[[nodiscard]] Pass<std::vector<Vec3>> bilateral_smoothing_pass(const BilateralSmoothingOptions& options,
                                                               bool keep_volume);

/// Bytes of the arrays that passes read and write.
struct PassBytes {
  explicit PassBytes(const HalfEdgeMesh& mesh);
  std::uint64_t per_vertex;  ///< One for each vertex.
  std::uint64_t points, corners, twins, normals_of_faces, values_of_half_edges, neighbours;
};

/// A row of the table.
struct PassRow {
  std::string name;   ///< As `digest` prints it; empty: not there.
  std::string title;  ///< As `bench` prints it; empty: not there.
  /// What the pass must read and write at least: its inputs and its results once, nothing in between.
  std::function<std::uint64_t(const PassBytes&)> bytes;
  std::uint32_t steps = 1;  ///< In one run; `bench` prints the time of one.
  std::function<Pass<std::any>(const PassInput&)> pass;
  /// FNV-1a (G. Fowler, L. C. Noll, K.-P. Vo) of the bytes of a result.
  std::function<std::uint64_t(const std::any&)> digest;
};

[[nodiscard]] const std::vector<PassRow>& pass_table();

}  // namespace vkmesh::cli
