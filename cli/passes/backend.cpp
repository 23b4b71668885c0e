#include "passes/backend.h"

#include <utility>

#include <vkmesh/mesh/node_neighbours.h>
#include <vkmesh/passes/restore_volume.h>

namespace vkmesh::cli {
namespace {

class HostBackend : public Backend {
 public:
  explicit HostBackend(Job& job) : job_(job) {}

  Result<std::vector<Vec3>> vertex_normals(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                           const VertexNormalsOptions& options) override {
    return job_.timed("compute", [&] { return vkmesh::vertex_normals(mesh, positions, options); });
  }

  Result<std::vector<Vec3>> triangle_normals(const HalfEdgeMesh& mesh,
                                             std::span<const Vec3> positions) override {
    return job_.timed("compute", [&] { return vkmesh::triangle_normals(mesh, positions); });
  }

  Result<DihedralAngles> dihedral_angles(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) override {
    return job_.timed("compute", [&] { return vkmesh::dihedral_angles(mesh, positions); });
  }

  Result<std::vector<VertexCurvature>> curvatures(const HalfEdgeMesh& mesh,
                                                  std::span<const Vec3> positions) override {
    return job_.timed("compute", [&]() -> Result<std::vector<VertexCurvature>> {
      VKMESH_TRY(const NodeNeighbours neighbours, node_neighbours(mesh));
      return vkmesh::curvatures(neighbours, positions);
    });
  }

  Result<SurfaceMeasures> surface_measures(const HalfEdgeMesh& mesh,
                                           std::span<const Vec3> positions) override {
    return job_.timed("compute", [&] { return vkmesh::surface_measures(mesh, positions); });
  }

  Result<std::vector<Vec3>> laplacian_smoothing(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                                const LaplacianSmoothingOptions& options,
                                                bool keep_volume) override {
    return job_.timed("compute", [&]() -> Result<std::vector<Vec3>> {
      VKMESH_TRY(const NodeNeighbours neighbours, node_neighbours(mesh));
      VKMESH_TRY(std::vector<Vec3> smoothed,
                 vkmesh::laplacian_smoothing(neighbours, positions, options, job_.progress("smoothing")));
      if (keep_volume) return restore_volume(mesh, positions, smoothed);
      return smoothed;
    });
  }

  Result<std::vector<Vec3>> bilateral_smoothing(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                                const BilateralSmoothingOptions& options,
                                                bool keep_volume) override {
    return job_.timed("compute", [&]() -> Result<std::vector<Vec3>> {
      VKMESH_TRY(std::vector<Vec3> smoothed,
                 vkmesh::bilateral_smoothing(mesh, positions, options, job_.progress("smoothing")));
      if (keep_volume) return restore_volume(mesh, positions, smoothed);
      return smoothed;
    });
  }

  Result<std::vector<float>> collapse_costs(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                            const CollapseCostOptions& options) override {
    return job_.timed("compute", [&]() -> Result<std::vector<float>> {
      VKMESH_TRY(const std::vector<VertexQuadric> planes, quadrics(mesh, positions, options));
      return vkmesh::collapse_costs(mesh, positions, planes, options);
    });
  }

  Result<std::vector<float>> swap_scores(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                         SwapCriterion criterion) override {
    return job_.timed("compute", [&] { return vkmesh::swap_scores(mesh, positions, criterion); });
  }

 private:
  Job& job_;
};

void report_host(Job& job) {
  job.json()["device"] = {{"name", "cpu"}, {"driver", "vkmesh " VKMESH_VERSION}, {"type", "host"}};
}

}  // namespace

void use_host(Job& job) {
  const std::string& asked = job.options().device;
  report_host(job);
  if (asked != "auto" && asked != "cpu")
    job.note("this subcommand runs on the host: the device " + asked + " was not used");
}

Result<std::unique_ptr<Backend>> open_backend(Job& job) {
  const std::string& asked = job.options().device;
  const char* why = "";
  if (asked != "cpu") {
#ifdef VKMESH_HAS_VULKAN
    auto vulkan = open_vulkan_backend(job, asked);
    if (vulkan || asked != "auto" || vulkan.error().code != ErrorCode::kNoDevice) return vulkan;
    why = " (no GPU)";
#else
    if (asked != "auto")
      return fail(ErrorCode::kNoDevice,
                  "there is no device " + asked + ": this program was built without Vulkan");
#endif
  }
  report_host(job);
  job.row("device", std::string("cpu") + why);
  return std::make_unique<HostBackend>(job);
}

}  // namespace vkmesh::cli
