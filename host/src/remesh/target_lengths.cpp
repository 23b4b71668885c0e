#include "remesh/target_lengths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <queue>
#include <utility>

#include <glm/geometric.hpp>

#include "math/angle.h"

namespace vkmesh::detail {
namespace {

/// A symmetric 3 × 3 matrix: xx, yy, zz, xy, yz, zx.
struct Tensor {
  std::array<double, 6> m{};

  void add(double weight, const DVec3& e) {
    const std::array<double, 6> outer = {e.x * e.x, e.y * e.y, e.z * e.z, e.x * e.y, e.y * e.z, e.z * e.x};
    for (std::size_t i = 0; i < 6; ++i) m[i] += weight * outer[i];
  }
  Tensor& operator+=(const Tensor& more) {
    for (std::size_t i = 0; i < 6; ++i) m[i] += more.m[i];
    return *this;
  }
  /// The largest magnitude of an eigenvalue, by rotations that take what is off the diagonal away (C. G. J.
  /// Jacobi, 1846); the same on every machine.
  [[nodiscard]] double largest_eigenvalue() const {
    std::array<std::array<double, 3>, 3> a = {{{m[0], m[3], m[5]}, {m[3], m[1], m[4]}, {m[5], m[4], m[2]}}};
    for (int sweep = 0; sweep < 6; ++sweep)
      for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 2}, {0, 2}}) {
        if (a[i][j] == 0) continue;
        const std::size_t k = 3 - i - j;
        const double half = (a[j][j] - a[i][i]) / (2 * a[i][j]),
                     t = std::copysign(1 / (std::fabs(half) + std::sqrt(half * half + 1)), half),
                     c = 1 / std::sqrt(t * t + 1), s = t * c, ik = a[i][k], jk = a[j][k];
        a[i][i] -= t * a[i][j];
        a[j][j] += t * a[i][j];
        a[i][j] = a[j][i] = 0;
        a[i][k] = a[k][i] = c * ik - s * jk;
        a[j][k] = a[k][j] = s * ik + c * jk;
      }
    return std::max({std::fabs(a[0][0]), std::fabs(a[1][1]), std::fabs(a[2][2])});
  }
};

constexpr double kGradation = 0.5;
constexpr double kLeastShare = 0.1;  // of the length elsewhere, next to short curves

}  // namespace

TargetLengths TargetLengths::by_curvature(const OriginalSurface& surface, const std::vector<bool>& is_curve,
                                          double tolerance, double least, double most) {
  const HalfEdgeMesh& mesh = surface.mesh();
  const std::size_t vertices = mesh.vertex_count(), faces = mesh.face_count();
  const auto origins = mesh.origins(), twins = mesh.twins();
  // The curvature tensor of the edges at each vertex times twice the area around it (D. Cohen-Steiner, J.-M.
  // Morvan, "Restricted Delaunay triangulations and normal cycle", 2003).
  std::vector<Tensor> bend(vertices);
  std::vector<double> area(vertices, 0.0);
  std::vector<DVec3> normal(faces);
  for (std::size_t f = 0; f < faces; ++f) {
    const DVec3 a = surface.position(origins[3 * f]);
    const DVec3 n =
        glm::cross(surface.position(origins[3 * f + 1]) - a, surface.position(origins[3 * f + 2]) - a);
    const double length = std::sqrt(glm::dot(n, n));
    for (std::size_t i = 0; i < 3; ++i) area[origins[3 * f + i]] += length / 6;
    normal[f] = length > 0 ? n / length : DVec3(0.0);
  }
  for (std::uint32_t h = 0; h < origins.size(); ++h) {
    const std::uint32_t t = twins[h];
    if (t == kInvalid || t < h || is_curve[h] || is_curve[t]) continue;
    const std::uint32_t v = origins[h], w = origins[t];
    DVec3 e = surface.position(w) - surface.position(v);
    const double length = std::sqrt(glm::dot(e, e));
    if (!(length > 0)) continue;
    e /= length;
    const DVec3 turn = glm::cross(normal[h / 3], normal[t / 3]);
    const double sine = glm::dot(turn, e), cosine = glm::dot(normal[h / 3], normal[t / 3]),
                 angle = std::copysign(angle_of(std::fabs(sine), cosine), sine);
    bend[v].add(angle * length, e);
    bend[w].add(angle * length, e);
  }
  // The means over each vertex and its neighbours: single edges of a scan say little.
  std::vector<Tensor> bends = bend;
  std::vector<double> areas = area;
  for (std::uint32_t h = 0; h < origins.size(); ++h) {
    const std::uint32_t v = origins[h], w = origins[h % 3 == 2 ? h - 2 : h + 1];
    bends[v] += bend[w];
    areas[v] += area[w];
    if (twins[h] != kInvalid) continue;
    bends[w] += bend[v];
    areas[w] += area[v];
  }
  TargetLengths result(most);
  result.of_vertex_.resize(vertices);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const double curvature = areas[v] > 0 ? bends[v].largest_eigenvalue() / (2 * areas[v]) : 0;
    const double squared =
        curvature > 0 ? 6 * tolerance / curvature - 3 * tolerance * tolerance : most * most;
    result.of_vertex_[v] = static_cast<float>(std::clamp(std::sqrt(std::max(squared, 0.0)), least, most));
  }
  result.grade(surface);
  return result;
}

void TargetLengths::shorten(const OriginalSurface& surface,
                            std::span<const std::pair<std::uint32_t, double>> at) {
  if (at.empty()) return;
  if (is_uniform()) of_vertex_.assign(surface.mesh().vertex_count(), static_cast<float>(uniform_));
  for (const auto& [v, length] : at) {
    const double least = std::max(length, kLeastShare * uniform_);
    of_vertex_[v] = std::min(of_vertex_[v], static_cast<float>(least));
  }
  grade(surface);
}

void TargetLengths::grade(const OriginalSurface& surface) {
  const HalfEdgeMesh& mesh = surface.mesh();
  using Entry = std::pair<float, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::uint32_t v = 0; v < of_vertex_.size(); ++v)
    if (of_vertex_[v] < static_cast<float>(uniform_)) queue.emplace(of_vertex_[v], v);
  // From the shortest on, to neighbours that are too long (E. W. Dijkstra, 1959).
  while (!queue.empty()) {
    const auto [length, v] = queue.top();
    queue.pop();
    if (length > of_vertex_[v] || mesh.leadings()[v] == kInvalid) continue;
    mesh.for_each_neighbour(VertexId(v), [&, length = length, v = v](VertexId w) {
      const double away = glm::length(surface.position(w.index) - surface.position(v));
      const auto longest = static_cast<float>(static_cast<double>(length) + kGradation * away);
      if (!(of_vertex_[w.index] > longest)) return;
      of_vertex_[w.index] = longest;
      queue.emplace(longest, w.index);
    });
  }
}

float TargetLengths::at(const OriginalSurface& surface, const Foot& foot) const {
  if (is_uniform()) return static_cast<float>(uniform_);
  const auto corners = surface.mesh().origins().subspan(3 * std::size_t{foot.face}, 3);
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += foot.weights[i] * static_cast<double>(of_vertex_[corners[i]]);
  return static_cast<float>(sum);
}

void TargetLengths::scale(double factor) {
  uniform_ *= factor;
  for (float& length : of_vertex_) length = static_cast<float>(static_cast<double>(length) * factor);
}

}  // namespace vkmesh::detail
