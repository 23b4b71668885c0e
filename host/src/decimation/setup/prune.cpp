#include "decimation/setup/prune.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <vkmesh/math/bounds.h>

#include "base/disjoint_sets.h"

namespace vkmesh::detail {

Result<Pruned> prune_components(CollapseMesh& mesh, float size, Stop& stop) {
  constexpr std::uint32_t kBetween = 1 << 16;  // faces from one question to the next
  const auto faces = static_cast<std::uint32_t>(mesh.face_count());
  DisjointSets sets(faces);
  for (std::uint32_t f = 0; f < faces; ++f) {
    if (f % kBetween == 0) VKMESH_CHECK(stop.go_on());
    for (const std::uint32_t t : mesh.face(4 * f).twin)
      if (!mesh.is_ghost(t)) sets.unite(f, t / 4);
  }
  const NumberedSets components = number_sets(sets);

  std::vector<Bounds> bounds(components.sizes.size());
  std::size_t largest = 0;
  for (std::size_t c = 1; c < bounds.size(); ++c)
    if (components.sizes[c] > components.sizes[largest]) largest = c;
  for (std::uint32_t f = 0; f < faces; ++f) {
    if (f % kBetween == 0) VKMESH_CHECK(stop.go_on());
    for (const std::uint32_t v : mesh.face(4 * f).origin) {
      const auto& p = mesh.vertices[v].position;
      bounds[components.of[f]].add({p[0], p[1], p[2]});
    }
  }

  Pruned pruned;
  std::vector<bool> goes(bounds.size(), false);
  for (std::size_t c = 0; c < bounds.size(); ++c) {
    const Vec3 d = bounds[c].extent();
    goes[c] = c != largest && std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) <= size;
    if (!goes[c]) continue;
    ++pruned.components;
    pruned.faces += components.sizes[c];
  }
  for (std::uint32_t f = 0; f < faces; ++f) {
    if (!goes[components.of[f]]) continue;
    for (const std::uint32_t v : mesh.face(4 * f).origin) {
      pruned.vertices += mesh.vertices[v].leading != kInvalid ? 1 : 0;
      mesh.vertices[v].leading = kInvalid;
    }
    mesh.erase_with_ghosts(f);
  }
  return pruned;
}

}  // namespace vkmesh::detail
