// What vkmesh bench times: passes on a mesh that is in place already, on the host or on a Vulkan device.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/node_neighbours.h>

#include "job/common.h"

namespace vkmesh::cli {

/// A mesh of one size.
struct BenchSubject {
  HalfEdgeMesh mesh;
  std::vector<Vec3> positions;
  NodeNeighbours neighbours;
};

/// Smoothing is timed by this many steps in one go; its rows are of one step.
inline constexpr std::uint32_t kBenchSteps = 10;

/// Decimation leaves this share of the triangles.
inline constexpr double kBenchRatio = 0.1;

struct BenchPass {
  std::string name;
  /// What the pass must read and write at least: its inputs and its results once, nothing in between.
  std::uint64_t bytes = 0;
  /// Of one run, in milliseconds; the first may be slower.
  std::function<Result<double>()> run;
};

/// Where passes run. They refer to the subject, which must outlive them.
class BenchPlace {
 public:
  BenchPlace() = default;
  virtual ~BenchPlace() = default;
  BenchPlace(const BenchPlace&) = delete;
  BenchPlace& operator=(const BenchPlace&) = delete;

  /// Calls use(pass) with each pass in turn; what a pass needs in place lives as long as that call.
  virtual Result<void> for_each_pass(const BenchSubject& subject, const std::string& only,
                                     const std::function<Result<void>(const BenchPass&)>& use) = 0;
  /// Milliseconds of a plain copy of so many bytes, each read and written.
  virtual Result<double> copy(std::uint64_t bytes) = 0;
};

/// What each pass touches.
struct BenchBytes {
  explicit BenchBytes(const BenchSubject& subject);
  std::uint64_t triangle_normals, vertex_normals, dihedral_angles, curvatures, smoothing_step, measures,
      bilateral_smoothing, collapse_costs, swap_scores, decimation;
};

/// The options of the bilateral row: σ_f of four mean edge lengths, σ_g of one.
struct BilateralWidth {
  float spatial, influence;
};
[[nodiscard]] BilateralWidth bench_widths(const BenchSubject& subject);

#ifdef VKMESH_HAS_VULKAN
/// On a device, chosen as ContextOptions::device is; reported in the job. Errors: kNoDevice, kOutOfMemory.
[[nodiscard]] Result<std::unique_ptr<BenchPlace>> open_vulkan_bench(Job& job, const std::string& device);
#endif

}  // namespace vkmesh::cli
