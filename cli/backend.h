// Where the compute passes of a subcommand run: their CPU references, or a Vulkan device.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/half_edge_mesh.h>
#include <vkmesh/passes/laplacian_smoothing.h>
#include <vkmesh/passes/vertex_normals.h>
#include <vkmesh/result.h>
#include <vkmesh/vec.h>

#include "common.h"

namespace vkmesh {
struct ContextOptions;
}

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
  /// DihedralAngles::vertex_maximum.
  [[nodiscard]] virtual Result<std::vector<float>> largest_dihedral_angles(
      const HalfEdgeMesh& mesh, std::span<const Vec3> positions) = 0;
  [[nodiscard]] virtual Result<std::vector<Vec3>> laplacian_smoothing(
      const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
      const LaplacianSmoothingOptions& options) = 0;
};

/// The backend that --device asks for, reported in the job. Errors: kNoDevice, kOutOfMemory.
[[nodiscard]] Result<std::unique_ptr<Backend>> open_backend(Job& job);

/// For subcommands that run on the host alone: reports that, and says so when another device was asked for.
void use_host(Job& job);

#ifdef VKMESH_HAS_VULKAN
/// How every subcommand opens a device. In debug builds the validation layer watches, and speaks on standard
/// error.
[[nodiscard]] ContextOptions context_options(const std::string& device);

/// A Vulkan device, chosen as ContextOptions::device is. Errors: kNoDevice, kOutOfMemory.
[[nodiscard]] Result<std::unique_ptr<Backend>> open_vulkan_backend(Job& job, const std::string& device);
#endif

}  // namespace vkmesh::cli
