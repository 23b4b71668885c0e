// Splitting polygons into triangles.
#pragma once

#include <cstdint>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/mesh/indexed_face_set.h>

namespace vkmesh {

struct Triangulated {
  IndexedFaceSet mesh;                     ///< Triangles only; same points and point channels.
  std::vector<std::uint32_t> source_face;  ///< For each triangle the face it came from.
};

/// Ear clipping (G. H. Meisters, "Polygons have ears", 1975) in the plane of each polygon's Newell normal.
/// Triangles pass unchanged; a face of n corners gives n - 2 triangles in its place, the same whichever
/// corner comes first. Diagonals that are edges of the mesh, or diagonals of another face, are avoided, so
/// that a manifold stays one; where no other diagonal lies inside a polygon its triangles may fold over.
/// Non-planar polygons are cut by their projection on that plane; where the projection has no ear left (it
/// crosses itself) the rest is cut as a fan. Corner and face channels follow. Faces of fewer than three
/// corners pass no triangle on: run consolidate first. About O(n log n) for a simple polygon of n corners (a
/// kd-tree finds the corners within an ear), more for one that crosses itself. Errors: kOutOfMemory.
[[nodiscard]] VKMESH_API Result<Triangulated> triangulate(const IndexedFaceSet& mesh);

}  // namespace vkmesh
