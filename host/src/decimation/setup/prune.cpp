#include "decimation/setup/prune.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace vkmesh::detail {
namespace {

float diagonal(const CollapseMesh& mesh, std::span<const std::uint32_t> faces) {
  std::array<float, 3> low, high;
  low.fill(std::numeric_limits<float>::infinity());
  high.fill(-std::numeric_limits<float>::infinity());
  for (const std::uint32_t f : faces)
    for (const std::uint32_t v : mesh.face(4 * f).origin)
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], mesh.vertices[v].position[k]);
        high[k] = std::max(high[k], mesh.vertices[v].position[k]);
      }
  const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
  return std::sqrt(x * x + y * y + z * z);
}

}  // namespace

Pruned prune_components(CollapseMesh& mesh, float size) {
  // Faces in the order of a walk through each component.
  std::vector<std::uint32_t> order;
  std::vector<std::size_t> starts;
  std::vector<bool> met(mesh.face_count(), false);
  order.reserve(mesh.face_count());
  for (std::uint32_t first = 0; first < mesh.face_count(); ++first) {
    if (met[first]) continue;
    std::size_t next = order.size();
    starts.push_back(next);
    const auto meet = [&](std::uint32_t f) {
      if (met[f]) return;
      met[f] = true;
      order.push_back(f);
    };
    meet(first);
    while (next < order.size()) {
      const CollapseMesh::Face& face = mesh.face(4 * order[next++]);
      for (const std::uint32_t t : face.twin)
        if (!mesh.is_ghost(t)) meet(t / 4);
    }
  }
  starts.push_back(order.size());
  const auto component = [&](std::size_t c) {
    return std::span(order).subspan(starts[c], starts[c + 1] - starts[c]);
  };
  std::size_t largest = 0;
  for (std::size_t c = 1; c + 1 < starts.size(); ++c)
    if (component(c).size() > component(largest).size()) largest = c;

  Pruned pruned;
  for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
    if (c == largest || !(diagonal(mesh, component(c)) <= size)) continue;
    ++pruned.components;
    pruned.faces += component(c).size();
    for (const std::uint32_t f : component(c))
      for (const std::uint32_t v : mesh.face(4 * f).origin) {
        pruned.vertices += mesh.vertices[v].leading != kInvalid ? 1 : 0;
        mesh.vertices[v].leading = kInvalid;
      }
    for (const std::uint32_t f : component(c)) mesh.erase_with_ghosts(f);
  }
  return pruned;
}

}  // namespace vkmesh::detail
