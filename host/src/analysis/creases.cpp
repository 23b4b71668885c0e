#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <vkmesh/analysis/creases.h>
#include <vkmesh/base/exceptions_to_result.h>

namespace vkmesh {
namespace {

Result<void> check(const HalfEdgeMesh& mesh, std::span<const Vec3> positions, std::span<const float> angles,
                   const CreaseOptions& options) {
  if (positions.size() != mesh.vertex_count())
    return fail(ErrorCode::kUsage, "creases need one position for each vertex");
  if (angles.size() != mesh.half_edge_count())
    return fail(ErrorCode::kUsage, "creases need one angle for each half-edge");
  if (!(options.soft_angle >= 0 && options.soft_angle <= options.sharp_angle &&
        options.sharp_angle <= std::numbers::pi))
    return fail(ErrorCode::kUsage, "crease angles must be 0 <= soft_angle <= sharp_angle <= pi");
  if (!(options.min_length >= 0)) return fail(ErrorCode::kUsage, "min_length of creases must be at least 0");
  return {};
}

/// The edges that are creases, at their vertices.
class CreaseGraph {
 public:
  CreaseGraph(const HalfEdgeMesh& mesh, std::span<const Vec3> positions)
      : mesh_(mesh), positions_(positions) {}

  void keep(std::uint32_t h) {
    const std::uint32_t a = mesh_.origin(HalfEdgeId(h)).index, b = mesh_.target(HalfEdgeId(h)).index;
    at_[a].push_back(h);
    at_[b].push_back(h);
  }

  /// Takes an edge away at both of its ends.
  void remove(std::uint32_t h) {
    for (const std::uint32_t v : {mesh_.origin(HalfEdgeId(h)).index, mesh_.target(HalfEdgeId(h)).index}) {
      const auto found = at_.find(v);
      std::erase(found->second, h);
      if (found->second.empty()) at_.erase(found);
    }
  }

  [[nodiscard]] std::size_t degree(std::uint32_t v) const {
    const auto found = at_.find(v);
    return found == at_.end() ? 0 : found->second.size();
  }

  [[nodiscard]] std::vector<Crease> chains() const {
    std::vector<Crease> result;
    std::vector<bool> used(mesh_.half_edge_count(), false);
    // Every chain is met from both of its ends, every loop first at its smallest vertex.
    for (const bool loops : {false, true})
      for (const auto& [v, edges] : at_) {
        if ((edges.size() == 2) != loops) continue;
        for (const std::uint32_t h : edges)
          if (!used[h]) result.push_back(follow(v, h, used));
      }
    return result;
  }

 private:
  [[nodiscard]] Crease follow(std::uint32_t start, std::uint32_t h, std::vector<bool>& used) const {
    Crease crease;
    std::uint32_t v = start;
    for (;;) {
      crease.vertices.push_back(v);
      crease.half_edges.push_back(h);
      used[h] = true;
      const std::uint32_t a = mesh_.origin(HalfEdgeId(h)).index, b = mesh_.target(HalfEdgeId(h)).index;
      const DVec3 along = DVec3(positions_[b]) - DVec3(positions_[a]);
      crease.length += std::sqrt(along.x * along.x + along.y * along.y + along.z * along.z);
      v = v == a ? b : a;
      const std::vector<std::uint32_t>& here = at_.at(v);
      if (here.size() != 2 || v == start) break;
      h = here[0] == h ? here[1] : here[0];
    }
    crease.closed = v == start;
    if (!crease.closed) crease.vertices.push_back(v);
    return crease;
  }

  const HalfEdgeMesh& mesh_;
  std::span<const Vec3> positions_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> at_;  // Ordered: chains come by their vertices.
};

/// One for each edge that is a crease: the smaller of its half-edges.
std::vector<std::uint32_t> crease_edges(const HalfEdgeMesh& mesh, std::span<const float> angles,
                                        const CreaseOptions& options) {
  const auto is_bent = [&](std::uint32_t h, double by) {
    if (mesh.twins()[h] == kInvalid) return options.boundary;
    const double angle = angles[h];
    return (angle >= by && options.kind != CreaseKind::kConcave) ||
           (-angle >= by && options.kind != CreaseKind::kConvex);
  };
  std::vector<std::vector<std::uint32_t>> soft_at;  // By vertex, of those that soft edges meet.
  std::vector<std::uint32_t> row(mesh.vertex_count(), kInvalid);
  std::vector<bool> reached(mesh.vertex_count(), false);
  std::vector<std::uint32_t> soft, front;
  mesh.for_each_edge([&](HalfEdgeId h) {
    if (!is_bent(h.index, options.soft_angle)) return;
    soft.push_back(h.index);
    const bool sharp = is_bent(h.index, options.sharp_angle);
    for (const std::uint32_t v : {mesh.origin(h).index, mesh.target(h).index}) {
      if (row[v] == kInvalid) {
        row[v] = static_cast<std::uint32_t>(soft_at.size());
        soft_at.emplace_back();
      }
      soft_at[row[v]].push_back(h.index);
      if (sharp && !reached[v]) {
        reached[v] = true;
        front.push_back(v);
      }
    }
  });
  while (!front.empty()) {
    const std::uint32_t v = front.back();
    front.pop_back();
    for (const std::uint32_t h : soft_at[row[v]])
      for (const std::uint32_t next : {mesh.origin(HalfEdgeId(h)).index, mesh.target(HalfEdgeId(h)).index})
        if (!reached[next]) {
          reached[next] = true;
          front.push_back(next);
        }
  }
  std::erase_if(soft, [&](std::uint32_t h) { return !reached[mesh.origin(HalfEdgeId(h)).index]; });
  std::sort(soft.begin(), soft.end());
  return soft;
}

/// Leaves out one short chain for each vertex that short chains with a free end hang on. Whether there were
/// any.
bool leave_out_short(CreaseGraph& graph, const std::vector<Crease>& chains, double min_length) {
  // The shortest at each vertex; loose pieces have a vertex of their own.
  std::map<std::uint32_t, const Crease*> shortest;
  for (const Crease& chain : chains) {
    if (chain.length >= min_length) continue;
    const std::uint32_t first = chain.vertices.front(), last = chain.vertices.back();
    const bool loose =
        chain.closed ? graph.degree(first) == 2 : graph.degree(first) == 1 || graph.degree(last) == 1;
    if (!loose) continue;
    const Crease*& other = shortest[graph.degree(first) == 1 ? last : first];
    if (other == nullptr || chain.length < other->length) other = &chain;
  }
  for (const auto& [vertex, chain] : shortest)
    for (const std::uint32_t h : chain->half_edges) graph.remove(h);
  return !shortest.empty();
}

}  // namespace

Result<std::vector<Crease>> find_creases(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                         std::span<const float> angles, const CreaseOptions& options) {
  return detail::catching([&]() -> Result<std::vector<Crease>> {
    VKMESH_CHECK(check(mesh, positions, angles, options));
    CreaseGraph graph(mesh, positions);
    for (const std::uint32_t h : crease_edges(mesh, angles, options)) graph.keep(h);
    std::vector<Crease> chains = graph.chains();
    while (options.min_length > 0 && leave_out_short(graph, chains, options.min_length))
      chains = graph.chains();
    return chains;
  });
}

}  // namespace vkmesh
