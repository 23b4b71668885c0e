// Crease edges, joined into polylines.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>

namespace vkmesh {

/// Which way a crease bends, as seen from outside.
enum class CreaseKind : std::uint8_t {
  kBoth,
  kConvex,   ///< Ridges only.
  kConcave,  ///< Valleys only.
};

struct CreaseOptions {
  double sharp_angle =
      0.6981317007977318;  ///< Edges bent by at least this are creases. Radians; default 40°.
  /// Edges bent by at least this carry on a crease that they are joined to through others like them. Radians,
  /// at most sharp_angle; default 20°.
  double soft_angle = 0.3490658503988659;
  /// Loose ends and loose pieces shorter than this, in units of the positions, are left out. Default 0.
  double min_length = 0.0;
  CreaseKind kind = CreaseKind::kBoth;
  bool boundary = false;  ///< Boundary edges count as sharp ones. Default false.
};

/// A chain of crease edges between two vertices where it ends or meets others, or a loop.
struct Crease {
  std::vector<std::uint32_t> vertices;    ///< In order; a loop does not repeat its first.
  std::vector<std::uint32_t> half_edges;  ///< Edge i, by the smaller of its half-edges, leaves vertices[i].
  bool closed = false;
  double length = 0.0;  ///< In units of the positions.
};

/// Edges by two thresholds (J. Canny, "A computational approach to edge detection", 1986, §VII: hysteresis):
/// those sharp, and those soft that are joined to a sharp one through soft ones. They are cut into chains at
/// the vertices where other than two of them meet. Chains shorter than min_length that end freely are left
/// out, at each vertex the shortest first, until there are none. Chains come in ascending order of their
/// first vertices, then loops in that of their smallest. `angles`: for each half-edge, as
/// DihedralAngles::half_edge. O(half-edges), and O(creases) for each round of leaving out. Errors: kUsage
/// for options out of range, or another number of angles or positions; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<std::vector<Crease>> find_creases(const HalfEdgeMesh& mesh,
                                                                  std::span<const Vec3> positions,
                                                                  std::span<const float> angles,
                                                                  const CreaseOptions& options = {});

}  // namespace vkmesh
