// meshoptimizer: decimation is all that it shares with us.
#include <memory>

#include <meshoptimizer.h>

#include "bench/contestants.h"

namespace vkmesh::bench {

void add_meshoptimizer(Programme& programme, const Input& input) {
  const std::string name = "meshoptimizer";
  programme.libraries.push_back({name, std::to_string(MESHOPTIMIZER_VERSION / 1000) + "." +
                                           std::to_string(MESHOPTIMIZER_VERSION % 1000 / 10)});
  const auto corners = std::make_shared<std::vector<std::uint32_t>>();
  programme.contestants.push_back({step::kDecimation, name,
                                   [&input, corners]() -> Result<double> {
                                     const IndexedFaceSet& mesh = input.mesh;
                                     corners->resize(mesh.corners.size());
                                     const Stopwatch watch;
                                     const std::size_t count = meshopt_simplify(
                                         corners->data(), mesh.corners.data(), mesh.corners.size(),
                                         &mesh.points[0].x, mesh.points.size(), sizeof(Vec3),
                                         3 * input.decimation_target, 1.0f, 0, nullptr);
                                     const double milliseconds = watch.milliseconds();
                                     corners->resize(count);
                                     return milliseconds;
                                   },
                                   [&input, corners] {
                                     return Surface{input.mesh.points, *corners};
                                   }});
}

}  // namespace vkmesh::bench
