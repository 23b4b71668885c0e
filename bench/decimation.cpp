// What decimations are compared on.
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <utility>

#include "bench/contestants.h"

namespace vkmesh::bench {
namespace {

/// A permutation of [0, count). std::shuffle would give another one with another library.
std::vector<std::uint32_t> random_order(std::size_t count, std::mt19937& random) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  return order;
}

std::string percent(double ratio) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g %%", 100 * ratio);
  return text.data();
}

}  // namespace

IndexedFaceSet shuffled(const IndexedFaceSet& mesh, std::uint32_t seed) {
  std::mt19937 random(seed);
  const std::vector<std::uint32_t> points = random_order(mesh.points.size(), random),
                                   faces = random_order(mesh.face_count(), random);
  IndexedFaceSet result;
  result.points.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) result.points[points[i]] = mesh.points[i];
  result.corners.reserve(mesh.corners.size());
  for (const std::uint32_t f : faces)
    for (const std::uint32_t c : mesh.face(f)) result.corners.push_back(points[c]);
  return result;
}

std::vector<DecimationCase> decimation_cases(const Input& input) {
  std::vector<DecimationCase> cases;
  for (const bool is_shuffled : {false, true})
    for (const double ratio : input.ratios)
      cases.push_back(
          {"decimation to " + percent(ratio) + (is_shuffled ? ", shuffled" : ""),
           is_shuffled ? input.shuffled : input.mesh, is_shuffled,
           static_cast<std::size_t>(std::llround(ratio * static_cast<double>(input.mesh.face_count())))});
  return cases;
}

void add_decimation(Programme& programme, const DecimationCase& wanted, const std::string& name,
                    std::function<Result<double>(Surface&)> run, bool slow) {
  const auto surface = std::make_shared<Surface>();
  programme.contestants.push_back({wanted.step, name,
                                   [surface, run = std::move(run)] { return run(*surface); },
                                   [surface] { return *surface; }, slow});
}

}  // namespace vkmesh::bench
