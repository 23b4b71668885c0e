#include <vkmesh/engine/passes/collapse_costs.h>
#include <vkmesh/passes/detail/raw_measures.h>

#include "passes/collapse_costs_params.h"
#include "shaders.h"

namespace vkmesh {

Result<void> record_collapse_costs(Recorder& recorder, DeviceMesh& mesh, const CollapseCostOptions& options) {
  if (!mesh.passes().collapse_costs)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass collapse_costs");
  VKMESH_CHECK(detail::require_collapse_cost_options(options));
  VKMESH_TRY(const Kernel* quadrics, Kernel::get(recorder.context(), shaders::quadrics));
  VKMESH_TRY(const Kernel* costs, Kernel::get(recorder.context(), shaders::collapse_costs));

  kernels::QuadricsParams of_vertices{};
  of_vertices.positions = mesh.positions().address();
  of_vertices.corners = mesh.corners().address();
  of_vertices.twins = mesh.twins().address();
  of_vertices.corner_offsets = mesh.corner_offsets().address();
  of_vertices.corner_half_edges = mesh.corner_half_edges().address();
  of_vertices.quadrics = mesh.quadrics().address();
  of_vertices.centre_x = options.centre.x;
  of_vertices.centre_y = options.centre.y;
  of_vertices.centre_z = options.centre.z;
  of_vertices.scale = options.scale;
  of_vertices.boundary_weight = options.boundary_weight;
  VKMESH_CHECK(recorder.dispatch(
      *quadrics, of_vertices, mesh.vertex_count(),
      {&mesh.positions(), &mesh.corners(), &mesh.twins(), &mesh.corner_offsets(), &mesh.corner_half_edges()},
      {&mesh.quadrics()}));

  kernels::CollapseCostsParams of_edges{};
  of_edges.positions = mesh.positions().address();
  of_edges.corners = mesh.corners().address();
  of_edges.twins = mesh.twins().address();
  of_edges.quadrics = mesh.quadrics().address();
  of_edges.costs = mesh.collapse_costs().address();
  of_edges.centre_x = options.centre.x;
  of_edges.centre_y = options.centre.y;
  of_edges.centre_z = options.centre.z;
  of_edges.scale = options.scale;
  of_edges.placement = static_cast<std::uint32_t>(options.placement);
  return recorder.dispatch(*costs, of_edges, mesh.half_edge_count(),
                           {&mesh.positions(), &mesh.corners(), &mesh.twins(), &mesh.quadrics()},
                           {&mesh.collapse_costs()});
}

}  // namespace vkmesh
