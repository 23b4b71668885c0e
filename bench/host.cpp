// vkmesh on the CPU.
#include <memory>
#include <utility>

#include <vkmesh/consolidate.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/node_neighbours.h>
#include <vkmesh/passes/laplacian_smoothing.h>
#include <vkmesh/passes/vertex_normals.h>

#include "bench/contestants.h"

namespace vkmesh::bench {
namespace {

/// Times a function that returns a Result; the result is let go of after the watch has stopped.
template <class Work>
Result<double> timed(Work&& work) {
  const Stopwatch watch;
  const auto result = work();
  const double milliseconds = watch.milliseconds();
  if (!result) return tl::unexpected<Error>(result.error());
  return milliseconds;
}

}  // namespace

Result<void> add_host(Programme& programme, const Input& input) {
  const std::string name = "vkmesh, CPU";
  VKMESH_TRY(HalfEdgeMesh half_edges, to_half_edge_mesh(input.mesh));
  const auto mesh = std::make_shared<HalfEdgeMesh>(std::move(half_edges));
  VKMESH_TRY(NodeNeighbours lists, node_neighbours(*mesh));
  const auto neighbours = std::make_shared<NodeNeighbours>(std::move(lists));

  programme.contestants.push_back(
      {step::kConstruction, name, [&input] { return timed([&] { return to_half_edge_mesh(input.mesh); }); }});
  programme.contestants.push_back(
      {step::kNeighbours, name, [mesh] { return timed([&] { return node_neighbours(*mesh); }); }});
  programme.contestants.push_back({step::kNormals, name, [&input, mesh] {
                                     return timed([&] { return vertex_normals(*mesh, input.mesh.points); });
                                   }});
  programme.contestants.push_back(
      {step::kSmoothing, name, [&input, neighbours] {
         LaplacianSmoothingOptions options;
         options.iterations = kSmoothingSteps;
         return timed([&] { return laplacian_smoothing(*neighbours, input.mesh.points, options); });
       }});
  for (const auto& [operation, what] :
       {std::pair(DecimateOperation::kEdgeCollapse, ", edge collapse"),
        std::pair(DecimateOperation::kHalfEdgeCollapse, ", half-edge collapse"),
        std::pair(DecimateOperation::kVertexRemoval, ", vertex removal")}) {
    const auto decimated = std::make_shared<Decimated>();
    programme.contestants.push_back(
        {step::kDecimation, name + what,
         [&input, operation = operation, decimated]() -> Result<double> {
           DecimateOptions options;
           options.operation = operation;
           options.target_faces = input.decimation_target;
           const Stopwatch watch;
           auto result = decimate(TriangleSurface{input.mesh.points, input.mesh.corners}, options);
           const double milliseconds = watch.milliseconds();
           if (!result) return tl::unexpected<Error>(result.error());
           *decimated = std::move(*result);
           return milliseconds;
         },
         [decimated] {
           const auto corners = decimated->mesh.origins();
           return Surface{decimated->positions, {corners.begin(), corners.end()}};
         }});
  }
  return {};
}

}  // namespace vkmesh::bench
