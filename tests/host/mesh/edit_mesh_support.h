// Meshes to edit, for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/mesh/indexed_face_set.h>

#include "mesh/edit/edit_mesh.h"

namespace vkmesh::test {

/// The mesh of a manifold face set. The source of a face is its number, and its tags are tags(number).
template <class Vertex, class Tags>
detail::EditMesh<Vertex> edit_mesh_of(const IndexedFaceSet& set, Tags&& tags) {
  using Mesh = detail::EditMesh<Vertex>;
  Mesh mesh;
  std::vector<std::uint32_t> leading;
  const auto face_of = [&](std::size_t f) {
    const auto c = set.face(f);
    const auto source = static_cast<std::uint32_t>(f);
    return typename Mesh::Face{{c[0], c[1], c[2]}, tags(source), {}, source};
  };
  REQUIRE(mesh.build(set.points.size(), set.face_count(), face_of, leading) == Mesh::Built::kDone);
  for (std::size_t v = 0; v < leading.size(); ++v) {
    mesh.vertices[v] = {};
    mesh.vertices[v].leading = leading[v];
  }
  return mesh;
}
template <class Vertex>
detail::EditMesh<Vertex> edit_mesh_of(const IndexedFaceSet& set) {
  return edit_mesh_of<Vertex>(set, [](std::uint32_t) { return 0u; });
}

}  // namespace vkmesh::test
