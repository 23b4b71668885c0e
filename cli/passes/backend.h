// Where the compute passes of a subcommand run: their CPU references, or a Vulkan device.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/passes/bilateral_smoothing.h>
#include <vkmesh/passes/collapse_costs.h>
#include <vkmesh/passes/curvatures.h>
#include <vkmesh/passes/dihedral_angles.h>
#include <vkmesh/passes/laplacian_smoothing.h>
#include <vkmesh/passes/surface_measures.h>
#include <vkmesh/passes/swap_scores.h>
#include <vkmesh/passes/triangle_normals.h>
#include <vkmesh/passes/vertex_normals.h>

#include "job/common.h"

namespace vkmesh {
class Context;
struct ContextOptions;
}  // namespace vkmesh

namespace vkmesh::cli {

/// The passes, as the functions of the same names in vkmesh/passes/. All backends give the same bits, and
/// book their times in the job they were opened for.
class Backend {
 public:
  Backend() = default;
  virtual ~Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;

  [[nodiscard]] virtual Result<std::vector<Vec3>> vertex_normals(const HalfEdgeMesh& mesh,
                                                                 std::span<const Vec3> positions,
                                                                 const VertexNormalsOptions& options) = 0;
  [[nodiscard]] virtual Result<std::vector<Vec3>> triangle_normals(const HalfEdgeMesh& mesh,
                                                                   std::span<const Vec3> positions) = 0;
  [[nodiscard]] virtual Result<DihedralAngles> dihedral_angles(const HalfEdgeMesh& mesh,
                                                               std::span<const Vec3> positions) = 0;
  [[nodiscard]] virtual Result<std::vector<VertexCurvature>> curvatures(const HalfEdgeMesh& mesh,
                                                                        std::span<const Vec3> positions) = 0;
  [[nodiscard]] virtual Result<SurfaceMeasures> surface_measures(const HalfEdgeMesh& mesh,
                                                                 std::span<const Vec3> positions) = 0;
  /// With keep_volume restore_volume() follows.
  [[nodiscard]] virtual Result<std::vector<Vec3>> laplacian_smoothing(
      const HalfEdgeMesh& mesh, std::span<const Vec3> positions, const LaplacianSmoothingOptions& options,
      bool keep_volume) = 0;
  [[nodiscard]] virtual Result<std::vector<Vec3>> bilateral_smoothing(
      const HalfEdgeMesh& mesh, std::span<const Vec3> positions, const BilateralSmoothingOptions& options,
      bool keep_volume) = 0;
  [[nodiscard]] virtual Result<std::vector<float>> collapse_costs(const HalfEdgeMesh& mesh,
                                                                  std::span<const Vec3> positions,
                                                                  const CollapseCostOptions& options) = 0;
  [[nodiscard]] virtual Result<std::vector<float>> swap_scores(const HalfEdgeMesh& mesh,
                                                               std::span<const Vec3> positions,
                                                               SwapCriterion criterion) = 0;
};

/// The backend that --device asks for, reported in the job. Errors: kNoDevice, kOutOfMemory.
[[nodiscard]] Result<std::unique_ptr<Backend>> open_backend(Job& job);

/// For subcommands that run on the host alone: reports that, and says so when another device was asked for.
void use_host(Job& job);

#ifdef VKMESH_HAS_VULKAN
/// How every subcommand opens a device. In debug builds the validation layer watches, and speaks on standard
/// error.
[[nodiscard]] ContextOptions context_options(const std::string& device);

/// A Vulkan device, chosen as ContextOptions::device is, reported in the job. Errors: kNoDevice,
/// kOutOfMemory.
[[nodiscard]] Result<std::unique_ptr<Context>> open_context(Job& job, const std::string& device);

/// A backend on a Vulkan device, chosen as ContextOptions::device is. Errors: kNoDevice, kOutOfMemory.
[[nodiscard]] Result<std::unique_ptr<Backend>> open_vulkan_backend(Job& job, const std::string& device);
#endif

}  // namespace vkmesh::cli
