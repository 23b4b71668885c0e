#include "decimation/reference_target.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "decimation/reference.h"

namespace vkmesh::detail {
namespace {

using Vertex = std::uint32_t;

/// A part of more vertices is not decimated to the end to see what is left of it.
constexpr std::size_t kMostVertices = 1000;

class HeldVertices {
 public:
  HeldVertices(const TriangleSurface& surface, const DecimateOptions& options)
      : surface_(surface), options_(options) {
    for (std::size_t c = 0; c < surface.corners.size(); c += 3)
      for (std::size_t i = 0; i < 3; ++i) {
        const Vertex v = surface.corners[c + i], w = surface.corners[c + (i + 1) % 3];
        neighbours_[v].insert(w);
        neighbours_[w].insert(v);
      }
    for (const Vertex v : options.locked.vertices)
      if (neighbours_.contains(v)) locked_.insert(v);
  }

  [[nodiscard]] std::size_t used() const { return neighbours_.size(); }

  /// What is locked, or needed by spheres, of which there are as many as Euler's characteristic tells; of
  /// several small parts what is left of each alone.
  [[nodiscard]] std::size_t count() const {
    std::size_t ends = 0;  // of edges, each edge at either vertex
    for (const auto& [v, ring] : neighbours_) ends += ring.size();
    const std::size_t edges = ends / 2, others = used() + surface_.corners.size() / 3;
    if (others <= edges + 2) return std::max(locked_.size(), 2 * (std::max(others, edges) - edges));
    std::size_t held = 0;
    std::set<Vertex> rest;
    for (const auto& [v, ring] : neighbours_) rest.insert(v);
    while (!rest.empty()) {
      std::set<Vertex> part;
      for (std::vector<Vertex> next = {*rest.begin()}; !next.empty();) {
        const Vertex v = next.back();
        next.pop_back();
        if (!part.insert(v).second) continue;
        rest.erase(v);
        const std::set<Vertex>& ring = neighbours_.at(v);
        next.insert(next.end(), ring.begin(), ring.end());
      }
      held += part.size() > kMostVertices ? std::max<std::size_t>(locked_in(part), 4) : left_of(part);
    }
    return held;
  }

 private:
  [[nodiscard]] std::size_t locked_in(const std::set<Vertex>& part) const {
    return static_cast<std::size_t>(
        std::ranges::count_if(part, [&](Vertex v) { return locked_.contains(v); }));
  }

  /// What is left of a part that is decimated alone.
  [[nodiscard]] std::size_t left_of(const std::set<Vertex>& part) const {
    DecimateOptions alone = options_;
    alone.target = {};
    std::map<Vertex, Vertex> number;
    std::vector<Vec3> points;
    std::vector<std::uint32_t> corners, locked;
    for (const Vertex v : part) {
      number[v] = static_cast<Vertex>(points.size());
      if (locked_.contains(v)) locked.push_back(number[v]);
      points.push_back(surface_.points[v]);
    }
    alone.locked.vertices = locked;
    for (const Vertex v : surface_.corners)
      if (part.contains(v)) corners.push_back(number.at(v));
    std::set<Vertex> left;
    for (const auto& face : decimate_by_reference({points, corners}, alone).faces)
      left.insert(face.begin(), face.end());
    return left.size();
  }

  const TriangleSurface& surface_;
  const DecimateOptions& options_;
  std::set<Vertex> locked_;
  std::map<Vertex, std::set<Vertex>> neighbours_;
};

}  // namespace

std::size_t least_vertices_by_reference(const TriangleSurface& surface, std::size_t faces,
                                        const DecimateOptions& options) {
  const std::size_t asked_for = options.target.vertices.value_or(0);
  if (options.target.force || surface.corners.empty()) return asked_for;
  const HeldVertices vertices(surface, options);
  const auto all = static_cast<double>(vertices.used());
  const double asked = static_cast<double>(asked_for) / all,
               of_faces = 3 * static_cast<double>(faces) / static_cast<double>(surface.corners.size()),
               share = std::min(1.0, std::max(asked, of_faces));
  if (share == 0) return asked_for;
  const auto held = static_cast<double>(std::min(vertices.count(), vertices.used()));
  const double kept = share * (all - held) / 8;
  return std::max(asked_for, kept >= 1 ? static_cast<std::size_t>(held + kept) : 0);
}

}  // namespace vkmesh::detail
