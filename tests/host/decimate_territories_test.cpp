#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include <catch2/catch.hpp>

#include "decimation/collapse_mesh.h"
#include "decimation/territories.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

using detail::CollapseMesh;
using detail::Territory;

constexpr std::uint8_t kInner = Territory::kInner;

CollapseMesh mesh_of(const IndexedFaceSet& set) {
  CollapseMesh mesh;
  std::vector<std::uint32_t> leading;
  const auto face_of = [&](std::size_t f) {
    const auto corners = set.face(f);
    return CollapseMesh::Face{{corners[0], corners[1], corners[2]}, 0, {}, static_cast<std::uint32_t>(f)};
  };
  REQUIRE(mesh.build(set.points.size(), set.face_count(), face_of, leading) == CollapseMesh::Built::kDone);
  float size = 0;
  for (const Vec3& p : set.points) size = std::max({size, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  for (std::uint32_t v = 0; v < set.points.size(); ++v) {
    const Vec3 p = 0.5f / size * set.points[v];
    mesh.vertices[v] = {};
    mesh.vertices[v].position = {p.x, p.y, p.z};
    mesh.vertices[v].leading = leading[v];
  }
  mesh.vertices[mesh.apex()] = {};
  return mesh;
}

std::vector<std::uint32_t> ring_of(const CollapseMesh& mesh, std::uint32_t v) {
  std::vector<std::uint32_t> ring;
  const std::uint32_t first = mesh.vertices[v].leading;
  std::uint32_t h = first;
  do {
    ring.push_back(mesh.target(h));
    h = mesh.around_vertex(h);
  } while (h != first);
  return ring;
}

/// What makes it safe that threads work on the parts, by definition.
void check(const CollapseMesh& mesh, const std::vector<std::uint8_t>& labels) {
  for (std::uint32_t v = 0; v < mesh.apex(); ++v) {
    if (!mesh.vertices[v].alive() || (labels[v] & kInner) == 0) continue;
    for (const std::uint32_t r : ring_of(mesh, v))
      if (r != mesh.apex()) REQUIRE((labels[r] & ~kInner) == (labels[v] & ~kInner));
  }
  for (std::uint32_t h = 0; h < mesh.half_edge_bound(); ++h) {
    if (h % 4 == 3 || !mesh.alive(h)) continue;
    const std::uint32_t p = mesh.origin(h), q = mesh.target(h);
    if (p == mesh.apex() || q == mesh.apex()) continue;
    REQUIRE(mesh.at_seam(h) == (((labels[p] & labels[q]) & kInner) == 0));
  }
}

bool link_condition(const CollapseMesh& mesh, std::uint32_t p, std::uint32_t q) {
  const auto at_p = ring_of(mesh, p), at_q = ring_of(mesh, q);
  const std::set<std::uint32_t> one(at_p.begin(), at_p.end()), other(at_q.begin(), at_q.end());
  return std::ranges::count_if(one, [&](std::uint32_t v) { return other.contains(v); }) == 2 &&
         at_p.size() + at_q.size() > 7;
}

}  // namespace

TEST_CASE("parts of a surface are compact, of one size, and stay apart through collapses on the seam",
          "[decimate]") {
  const std::vector<IndexedFaceSet> shapes = {test::icosphere(3), test::torus(24, 14), test::grid(20, 22)};
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const IndexedFaceSet& shape = shapes[seed % shapes.size()];
    CollapseMesh mesh = mesh_of(shape);
    const std::size_t parts = seed < 3 ? 4 : 8;
    std::vector<std::uint8_t> labels = detail::divide(mesh, parts);
    REQUIRE(labels.size() == shape.points.size() + 1);
    for (std::uint32_t h = 0; h < mesh.half_edge_bound(); h += 4) detail::mark_seam(labels, mesh.face(h));
    check(mesh, labels);
    std::vector<std::size_t> size(parts);
    std::size_t seam = 0;
    for (std::uint32_t v = 0; v < mesh.apex(); ++v) {
      REQUIRE((labels[v] & ~kInner) < static_cast<int>(parts));
      ++size[labels[v] & ~kInner];
      const auto ring = ring_of(mesh, v);
      const bool foreign = std::ranges::any_of(ring, [&](std::uint32_t r) {
        return r != mesh.apex() && (labels[r] & ~kInner) != (labels[v] & ~kInner);
      });
      REQUIRE(foreign == ((labels[v] & kInner) == 0));
      seam += foreign ? 1 : 0;
    }
    // As even as rows of equal coordinates allow; a compact part of m vertices has about 4√m on its rim.
    const auto [least, most] = std::ranges::minmax(size);
    CHECK(3 * least > most);
    CHECK(seam < shape.points.size() * 7 / 10);

    Territory everywhere(labels, Territory::kSeam);
    std::mt19937 random(seed);
    std::size_t collapses = 0;
    for (int i = 0; i < 3000; ++i) {
      const auto h = static_cast<std::uint32_t>(random() % mesh.half_edge_bound());
      if (h % 4 == 3 || !mesh.alive(h) || !mesh.at_seam(h)) continue;
      const std::uint32_t p = mesh.origin(h), q = mesh.target(h);
      if (p == mesh.apex() || q == mesh.apex() || !link_condition(mesh, p, q)) continue;
      const auto ring = ring_of(mesh, p);
      mesh.collapse(h);
      everywhere.merge(mesh, p, q, ring);
      if (++collapses % 8 == 0) check(mesh, labels);
    }
    CHECK(collapses > 50);
    check(mesh, labels);
  }
}

}  // namespace vkmesh
