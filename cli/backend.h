// Where the compute passes of a subcommand run: their CPU references, or a Vulkan device.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <vkmesh/half_edge_mesh.h>
#include <vkmesh/passes/laplacian_smoothing.h>
#include <vkmesh/result.h>
#include <vkmesh/vec.h>

#include "common.h"

namespace vkmesh::cli {

class Backend {
 public:
  /// What --device asks for; reported in the job. Errors: kNoDevice.
  [[nodiscard]] static Result<Backend> open(Job& job);

  Backend(Backend&&) noexcept;
  Backend& operator=(Backend&&) noexcept;
  ~Backend();

  // As the functions of the same names in vkmesh/passes/. Both kinds of backend give the same bits.
  [[nodiscard]] Result<std::vector<Vec3>> vertex_normals(const HalfEdgeMesh& mesh,
                                                         std::span<const Vec3> positions);
  [[nodiscard]] Result<std::vector<float>> largest_dihedral_angles(const HalfEdgeMesh& mesh,
                                                                   std::span<const Vec3> positions);
  [[nodiscard]] Result<std::vector<Vec3>> laplacian_smoothing(const HalfEdgeMesh& mesh,
                                                              std::span<const Vec3> positions,
                                                              const LaplacianSmoothingOptions& options);

 private:
  struct Vulkan;

  Backend(Job& job, std::unique_ptr<Vulkan> vulkan);

  Job* job_;
  std::unique_ptr<Vulkan> vulkan_;  ///< Null: the CPU references.
};

/// For subcommands that run on the host alone: reports that, and says so when another device was asked for.
void use_host(Job& job);

}  // namespace vkmesh::cli
