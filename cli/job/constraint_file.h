// Files of lines between points: constraints of a triangulation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/planar/constrained_delaunay.h>

namespace vkmesh::cli {

struct ConstraintFile {
  /// OBJ: the file's points, which its lines name. Else they name those of the mesh.
  bool has_points = false;
  std::vector<DVec3> points;
  /// Segments of open lines, and of closed ones.
  std::vector<PointPair> lines, loops;
};

/// Reads the lines of an OBJ file (v, l, and f, whose outline is a closed line), or of a text file with the
/// numbers of two points in each line, the first point being 0. Pairs that go on where the last ended are one
/// line; one that returns to its first point is closed. Errors: kUnreadable, with the line.
[[nodiscard]] Result<ConstraintFile> read_constraints(const std::filesystem::path& path);

}  // namespace vkmesh::cli
