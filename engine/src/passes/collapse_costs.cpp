#include <vkmesh/engine/core/dispatch.h>
#include <vkmesh/engine/passes/collapse_costs.h>
#include <vkmesh/passes/detail/raw_measures.h>

#include "passes/collapse_costs_params.h"
#include "shaders.h"

namespace vkmesh {

Result<void> record_collapse_costs(Recorder& recorder, DeviceMesh& mesh, DeviceCollapseCosts& result,
                                   const CollapseCostOptions& options) {
  VKMESH_CHECK(detail::require_collapse_cost_options(options));
  using Q = kernels::QuadricsParams;
  VKMESH_CHECK(Dispatch<Q>(recorder, shaders::vertex_quadrics, mesh.vertex_count())
                   .read(&Q::positions, mesh.positions())
                   .read(&Q::corners, mesh.corners())
                   .read(&Q::twins, mesh.twins())
                   .read(&Q::corner_offsets, mesh.corner_offsets())
                   .read(&Q::corner_half_edges, mesh.corner_half_edges())
                   .write(&Q::quadrics, result.quadrics, mesh.vertex_count())
                   .set(&Q::centre_x, options.centre.x)
                   .set(&Q::centre_y, options.centre.y)
                   .set(&Q::centre_z, options.centre.z)
                   .set(&Q::scale, options.scale)
                   .set(&Q::boundary_weight, options.boundary_weight)
                   .record());
  using P = kernels::CollapseCostsParams;
  return Dispatch<P>(recorder, shaders::collapse_costs, mesh.half_edge_count())
      .read(&P::positions, mesh.positions())
      .read(&P::corners, mesh.corners())
      .read(&P::twins, mesh.twins())
      .read(&P::quadrics, result.quadrics)
      .write(&P::costs, result.costs, mesh.half_edge_count())
      .set(&P::centre_x, options.centre.x)
      .set(&P::centre_y, options.centre.y)
      .set(&P::centre_z, options.centre.z)
      .set(&P::scale, options.scale)
      .set(&P::placement, static_cast<std::uint32_t>(options.placement))
      .record();
}

}  // namespace vkmesh
