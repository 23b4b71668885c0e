#include "decimation/setup/held_vertices.h"

#include <algorithm>
#include <cmath>

#include <vkmesh/mesh/handles.h>

#include "base/disjoint_sets.h"

namespace vkmesh::detail {
namespace {

constexpr std::size_t kTried = 64;  // parts
/// What is left of a sphere by the least, and by the most that is reckoned with before any is tried.
constexpr std::size_t kLeast = 4, kMost = 32;

bool stays(const VertexRecord& vertex) {
  return vertex.alive() && vertex.has(VertexRecord::kLocked);
}

bool can_be_locked(const DecimateOptions& options) {
  const DecimateLocks& locks = options.locked;
  return !locks.vertices.empty() || !locks.edges.empty() || !locks.faces.empty() ||
         options.curves.boundary == DecimateBoundary::kKept || !options.attributes.empty() ||
         !options.corner_groups.empty();
}

/// The components of the faces that are left.
class Components {
 public:
  explicit Components(const CollapseMesh& mesh) : mesh_(mesh), vertices_(0), locked_(0) {
    const auto faces = static_cast<std::uint32_t>(mesh.face_count());
    DisjointSets sets(faces);
    for (std::uint32_t f = 0; f < faces; ++f) {
      if (!mesh.alive(4 * f)) continue;
      for (const std::uint32_t t : mesh.face(4 * f).twin)
        if (!mesh.is_ghost(t)) sets.unite(f, t / 4);
    }
    of_ = number_sets(sets).of;
    const std::size_t count = of_.empty() ? 0 : std::size_t{std::ranges::max(of_)} + 1;
    vertices_.assign(count, 0);
    locked_.assign(count, 0);
    for (std::uint32_t v = 0; v < mesh.apex(); ++v) {
      const VertexRecord& vertex = mesh.vertices[v];
      if (!vertex.alive()) continue;
      std::uint32_t h = vertex.leading;
      if (mesh.is_ghost(h)) h = mesh.around_vertex(h);
      ++vertices_[of_[h / 4]];
      locked_[of_[h / 4]] += stays(vertex) ? 1 : 0;
    }
  }

  [[nodiscard]] std::size_t count() const { return vertices_.size(); }
  /// 0 for one that was pruned.
  [[nodiscard]] std::size_t vertices(std::size_t part) const { return vertices_[part]; }
  [[nodiscard]] std::size_t locked(std::size_t part) const { return locked_[part]; }

  /// Those of the given numbers, which ascend.
  [[nodiscard]] std::vector<Part> parts(std::span<const std::uint32_t> chosen) const {
    std::vector<std::uint32_t> place(count(), kInvalid);
    for (std::uint32_t i = 0; i < chosen.size(); ++i) place[chosen[i]] = i;
    std::vector<Part> result(chosen.size());
    for (std::uint32_t f = 0; f < of_.size(); ++f) {
      const std::uint32_t i = place[of_[f]];
      if (i == kInvalid || !mesh_.alive(4 * f)) continue;
      const auto& origin = mesh_.face(4 * f).origin;
      result[i].corners.insert(result[i].corners.end(), origin.begin(), origin.end());
    }
    for (Part& part : result) {
      part.vertices = part.corners;
      std::ranges::sort(part.vertices);
      part.vertices.erase(std::unique(part.vertices.begin(), part.vertices.end()), part.vertices.end());
      for (std::uint32_t& c : part.corners)
        c = static_cast<std::uint32_t>(std::ranges::lower_bound(part.vertices, c) - part.vertices.begin());
    }
    return result;
  }

 private:
  const CollapseMesh& mesh_;
  std::vector<std::uint32_t> of_;  // by face
  std::vector<std::size_t> vertices_, locked_;
};

}  // namespace

Result<std::size_t> held_vertices(const CollapseMesh& mesh, const DecimateOptions& options, std::size_t faces,
                                  std::size_t vertices, double target, const LeftAlone& left_alone,
                                  Stop& stop) {
  std::size_t locked = 0;
  if (can_be_locked(options))
    for (std::uint32_t v = 0; v < mesh.apex(); ++v) locked += stays(mesh.vertices[v]) ? 1 : 0;
  // No more components than half of Euler's characteristic would be no spheres.
  const std::size_t boundary = mesh.half_edge_bound() / 4 - mesh.face_count();
  const auto euler =
      static_cast<std::ptrdiff_t>(vertices + faces) - static_cast<std::ptrdiff_t>((3 * faces + boundary) / 2);
  const std::size_t twice = static_cast<std::size_t>(2 * std::max<std::ptrdiff_t>(euler, 0));
  if (euler <= 2 || static_cast<double>(twice / 2 * kMost / 2) < target) return std::max(locked, twice);

  const Components components(mesh);
  VKMESH_CHECK(stop.go_on());
  std::vector<std::uint32_t> small;
  std::size_t held = 0;
  for (std::uint32_t i = 0; i < components.count(); ++i) {
    const std::size_t all = components.vertices(i);
    if (all > kMostVertices)
      held += std::max(components.locked(i), kLeast);
    else if (all > 0)
      small.push_back(i);
  }
  if (small.empty()) return held;
  const std::size_t tried = std::min(small.size(), kTried);
  std::vector<std::uint32_t> chosen;
  for (std::size_t i = 0; i < tried; ++i) chosen.push_back(small[i * small.size() / tried]);
  std::size_t left = 0;
  for (const Part& part : components.parts(chosen)) {
    VKMESH_CHECK(stop.go_on());
    VKMESH_TRY(const std::size_t alone, left_alone(part));
    left += alone;
  }
  return held +
         static_cast<std::size_t>(std::llround(static_cast<double>(left) * static_cast<double>(small.size()) /
                                               static_cast<double>(tried)));
}

}  // namespace vkmesh::detail
