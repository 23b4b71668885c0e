// What exactness costs on the CPU: functions of the arithmetic over arrays, and the same with those of
// <cmath>.
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/math/arithmetic.h>

#include "bench/contestants.h"
#include "simd/target_clones.h"

namespace vkmesh::bench {
namespace {

Vec3 built_in_unit_vector(Vec3 v) {
  const float squared = v.x * v.x + v.y * v.y + v.z * v.z;
  const float scale = squared > 0.0f ? 1.0f / std::sqrt(squared) : 0.0f;
  return v * scale;
}

float built_in_length(Vec3 v) {
  return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

float built_in_angle(Vec3 a, Vec3 b) {
  return 2.0f * std::atan2(built_in_length(a - b), built_in_length(a + b));
}

struct Arrays {
  std::vector<Vec3> vectors, units;
  std::vector<float> angles;
};

// Each of these loops is compiled as those of the library are.
VKMESH_CLONES void exact_units(Arrays& a) {
  for (std::size_t i = 0; i < a.vectors.size(); ++i) a.units[i] = unit_vector(a.vectors[i]);
}
VKMESH_CLONES void built_in_units(Arrays& a) {
  for (std::size_t i = 0; i < a.vectors.size(); ++i) a.units[i] = built_in_unit_vector(a.vectors[i]);
}
VKMESH_CLONES void exact_angles(Arrays& a) {
  for (std::size_t i = 1; i < a.vectors.size(); ++i)
    a.angles[i] = angle_between(a.vectors[i - 1], a.vectors[i]);
}
VKMESH_CLONES void built_in_angles(Arrays& a) {
  for (std::size_t i = 1; i < a.vectors.size(); ++i)
    a.angles[i] = built_in_angle(a.vectors[i - 1], a.vectors[i]);
}
VKMESH_CLONES void exact_exponentials(Arrays& a) {
  for (std::size_t i = 0; i < a.vectors.size(); ++i) a.angles[i] = exact::exponential(a.vectors[i].x);
}
VKMESH_CLONES void built_in_exponentials(Arrays& a) {
  for (std::size_t i = 0; i < a.vectors.size(); ++i) a.angles[i] = std::exp(a.vectors[i].x);
}

}  // namespace

void add_host_built_ins(Programme& programme, const Input& input) {
  const auto arrays = std::make_shared<Arrays>();
  for (const Vec3& p : input.mesh.points) arrays->vectors.push_back(unit_vector(p));
  arrays->units.resize(arrays->vectors.size());
  arrays->angles.resize(arrays->vectors.size());
  const auto add = [&](const std::string& function, void (*exact)(Arrays&), void (*built_in)(Arrays&)) {
    for (const auto& [name, loop] : {std::pair{std::string("exact, CPU"), exact}, {kBuiltIns, built_in}})
      programme.contestants.push_back(
          {function + " on the CPU against built-ins", name, [arrays, loop]() -> Result<double> {
             const Stopwatch watch;
             loop(*arrays);
             return watch.milliseconds();
           }});
  };
  add("unit vectors", exact_units, built_in_units);
  add("angles between vectors", exact_angles, built_in_angles);
  add("exponentials", exact_exponentials, built_in_exponentials);
}

}  // namespace vkmesh::bench
