// vkmesh on the CPU.
#include <memory>
#include <utility>

#include <tbb/task_arena.h>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/mesh/node_neighbours.h>
#include <vkmesh/passes/laplacian_smoothing.h>
#include <vkmesh/passes/vertex_normals.h>
#include <vkmesh/repair/consolidate.h>

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

struct Removal {
  const char* name;
  DecimateOperation operation;
  int threads;
};
constexpr Removal kRemovals[] = {{"edge collapse", DecimateOperation::kEdgeCollapse, 1},
                                 {"edge collapse, two threads", DecimateOperation::kEdgeCollapse, 2},
                                 {"half-edge collapse", DecimateOperation::kHalfEdgeCollapse, 1},
                                 {"vertex removal", DecimateOperation::kVertexRemoval, 1}};

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
  programme.contestants.push_back(
      {step::kNormals, name, [&input, mesh, normals = std::vector<Vec3>(mesh->vertex_count())]() mutable {
         return timed([&] { return vertex_normals(*mesh, input.mesh.points, normals); });
       }});
  programme.contestants.push_back(
      {step::kSmoothing, name, [&input, neighbours] {
         LaplacianSmoothingOptions options;
         options.iterations = kSmoothingSteps;
         return timed([&] { return laplacian_smoothing(*neighbours, input.mesh.points, options); });
       }});
  for (const DecimationCase& wanted : decimation_cases(input))
    for (const Removal& removal : kRemovals)
      add_decimation(
          programme, wanted, std::string("vkmesh, ") + removal.name,
          [&mesh = wanted.mesh, target = wanted.target, &removal](Surface& surface) -> Result<double> {
            DecimateOptions options;
            options.operation = removal.operation;
            options.target.faces = target;
            tbb::task_arena threads(removal.threads);
            threads.initialize();
            const Stopwatch watch;
            auto decimated = threads.execute([&] {
              return decimate(TriangleSurface{mesh.points, mesh.corners}, options);
            });
            const double milliseconds = watch.milliseconds();
            if (!decimated) return tl::unexpected<Error>(decimated.error());
            const auto corners = decimated->mesh.origins();
            surface = {std::move(decimated->positions), {corners.begin(), corners.end()}};
            return milliseconds;
          });
  return {};
}

}  // namespace vkmesh::bench
