// meshoptimizer: decimation is all that it shares with us.
#include <meshoptimizer.h>

#include "bench/contestants.h"

namespace vkmesh::bench {

void add_meshoptimizer(Programme& programme, const Input& input) {
  const std::string version =
      std::to_string(MESHOPTIMIZER_VERSION / 1000) + "." + std::to_string(MESHOPTIMIZER_VERSION % 1000 / 10);
  programme.libraries.push_back({"meshoptimizer", version});
  for (const DecimationCase& wanted : decimation_cases(input))
    add_decimation(programme, wanted, "meshoptimizer " + version + ", simplify",
                   [&mesh = wanted.mesh, target = wanted.target](Surface& surface) -> Result<double> {
                     surface.corners.resize(mesh.corners.size());
                     const Stopwatch watch;
                     const std::size_t count = meshopt_simplify(
                         surface.corners.data(), mesh.corners.data(), mesh.corners.size(), &mesh.points[0].x,
                         mesh.points.size(), sizeof(Vec3), 3 * target, 1.0f, 0, nullptr);
                     const double milliseconds = watch.milliseconds();
                     surface.corners.resize(count);
                     surface.points = mesh.points;
                     return milliseconds;
                   });
}

}  // namespace vkmesh::bench
