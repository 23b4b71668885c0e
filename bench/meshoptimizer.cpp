// meshoptimizer: decimation is all that it shares with us.
#include <meshoptimizer.h>

#include "bench/contestants.h"

#ifdef VKMESH_BENCH_NEWER_MESHOPTIMIZER
#include "bench/newer_meshoptimizer.h"
#endif

namespace vkmesh::bench {
namespace {

std::string version_text(int version) {
  return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

/// As meshopt_simplify of any version.
using Simplify = std::size_t (*)(unsigned*, const unsigned*, std::size_t, const float*, std::size_t,
                                 std::size_t, std::size_t, float, unsigned, float*);

void add_simplify(Programme& programme, const DecimationCase& wanted, const std::string& version,
                  Simplify simplify) {
  add_decimation(programme, wanted, "meshoptimizer " + version + ", simplify",
                 [&mesh = wanted.mesh, target = wanted.target, simplify](Surface& surface) -> Result<double> {
                   surface.corners.resize(mesh.corners.size());
                   const Stopwatch watch;
                   const std::size_t count = simplify(
                       surface.corners.data(), mesh.corners.data(), mesh.corners.size(), &mesh.points[0].x,
                       mesh.points.size(), sizeof(Vec3), 3 * target, 1.0f, 0, nullptr);
                   const double milliseconds = watch.milliseconds();
                   surface.corners.resize(count);
                   surface.points = mesh.points;
                   return milliseconds;
                 });
}

}  // namespace

void add_meshoptimizer(Programme& programme, const Input& input) {
  const std::string version = version_text(MESHOPTIMIZER_VERSION);
  programme.libraries.push_back({"meshoptimizer", version});
  for (const DecimationCase& wanted : decimation_cases(input))
    add_simplify(programme, wanted, version, meshopt_simplify);
}

#ifdef VKMESH_BENCH_NEWER_MESHOPTIMIZER
void add_newer_meshoptimizer(Programme& programme, const Input& input) {
  const std::string version = version_text(vkmesh_newer_meshopt_version());
  programme.libraries.push_back({"meshoptimizer", version});
  for (const DecimationCase& wanted : decimation_cases(input)) {
    add_simplify(programme, wanted, version, vkmesh_newer_meshopt_simplify);
    // It works in its arrays: they are copied before the clock runs.
    add_decimation(programme, wanted, "meshoptimizer " + version + ", simplifyWithUpdate",
                   [&mesh = wanted.mesh, target = wanted.target](Surface& surface) -> Result<double> {
                     surface = {mesh.points, mesh.corners};
                     const Stopwatch watch;
                     const std::size_t count = vkmesh_newer_meshopt_simplify_with_update(
                         surface.corners.data(), surface.corners.size(), &surface.points[0].x,
                         surface.points.size(), sizeof(Vec3), 3 * target, 1.0f);
                     const double milliseconds = watch.milliseconds();
                     surface.corners.resize(count);
                     return milliseconds;
                   });
  }
}
#endif

}  // namespace vkmesh::bench
