#include "optimize/swap_legality.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <glm/geometric.hpp>

#include "base/parallel.h"
#include "math/angle.h"

namespace vkmesh::detail {
namespace {

/// Twice the area of a triangle, along its normal. Where the points lie in a plane of equal coordinates its
/// one component has the right sign: products of differences of floats are exact in double.
DVec3 area_of(std::span<const DVec3> points, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return glm::cross(points[b] - points[a], points[c] - points[a]);
}

/// The dihedral angle of an edge: negative where its faces, of these areas, meet in a valley.
double dihedral_angle_at(const DVec3& left, const DVec3& right, const DVec3& edge) {
  const double angle = angle_between_normals(unit_or_zero(left), unit_or_zero(right));
  return glm::dot(glm::cross(left, right), edge) < 0 ? -angle : angle;
}

}  // namespace

Result<void> tag_kept_edges(SwapMesh& mesh, std::span<const DVec3> points, const SwapEdgesOptions& options) {
  const std::size_t faces = mesh.face_count();
  const auto check_size = [&](std::size_t size, std::size_t wanted, const char* what) -> Result<void> {
    if (size == 0 || size == wanted) return {};
    return fail(ErrorCode::kUsage,
                "swap_edges: " + std::to_string(size) + " " + what + " for " + std::to_string(wanted));
  };
  VKMESH_CHECK(check_size(options.corner_groups.size(), 3 * faces, "corner groups"));
  VKMESH_CHECK(check_size(options.face_groups.size(), faces, "face groups"));
  VKMESH_CHECK(check_size(options.region.size(), faces, "flags of a region"));
  const auto tag = [](SwapReason reason) { return static_cast<unsigned>(reason) - 1; };
  parallel_ranges(faces, std::size_t{1} << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t h = static_cast<std::uint32_t>(4 * f) + i, t = mesh.twin(h);
        if (mesh.is_ghost(t)) {
          mesh.set_tag(h, tag(SwapReason::kBoundary));
          continue;
        }
        const std::size_t g = t / 4;
        const auto group = [&](std::uint32_t half_edge) {
          return options.corner_groups[3 * (half_edge / 4) + half_edge % 4];
        };
        if (!options.corner_groups.empty() &&
            (group(h) != group(SwapMesh::next(t)) || group(SwapMesh::next(h)) != group(t)))
          mesh.set_tag(h, tag(SwapReason::kSeam));
        if (!options.face_groups.empty() && options.face_groups[f] != options.face_groups[g])
          mesh.set_tag(h, tag(SwapReason::kMaterialBorder));
        if (!options.region.empty() && (options.region[f] == 0 || options.region[g] == 0))
          mesh.set_tag(h, tag(SwapReason::kOutsideRegion));
        if (options.crease_angle) {
          const auto normal = [&](std::size_t face) {
            const auto& v = mesh.face(static_cast<std::uint32_t>(4 * face)).origin;
            return unit_or_zero(area_of(points, v[0], v[1], v[2]));
          };
          if (angle_between_normals(normal(f), normal(g)) >= *options.crease_angle)
            mesh.set_tag(h, tag(SwapReason::kCrease));
        }
      }
  });
  for (const std::uint32_t e : options.locked_edges) {
    if (e >= 3 * faces)
      return fail(ErrorCode::kUsage, "swap_edges: there is no half-edge " + std::to_string(e) + " to lock");
    const std::uint32_t h = e + e / 3;
    mesh.set_tag(h, tag(SwapReason::kLocked));
    mesh.set_tag(mesh.twin(h), tag(SwapReason::kLocked));
  }
  return {};
}

SwapReason judge_swap(const SwapMesh& mesh, std::span<const DVec3> points, const SwapBounds& bounds,
                      std::uint32_t h) {
  for (unsigned kept = static_cast<unsigned>(SwapReason::kBoundary);
       kept <= static_cast<unsigned>(SwapReason::kOutsideRegion); ++kept)
    if (mesh.has_tag(h, kept - 1)) return static_cast<SwapReason>(kept);
  const SwapQuad quad(mesh, h);
  const auto& [edge, twin, p, q, a, b] = quad;
  if (mesh.has_edge(a, b)) return SwapReason::kEdgeExists;
  const DVec3 f = area_of(points, p, q, a), g = area_of(points, q, p, b), mean = f + g;
  const std::array<DVec3, 2> made = {area_of(points, b, a, p), area_of(points, a, b, q)};
  for (const DVec3& n : made)
    if (!(glm::dot(n, mean) > 0)) return SwapReason::kNotConvex;
  for (const DVec3& n : made)
    for (const DVec3& old : {f, g})
      if (glm::dot(n, old) <= 0 && old != DVec3(0.0)) return SwapReason::kFoldOver;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const DVec3 pq = points[q] - points[p], ba = points[a] - points[b];
  if (bounds.dihedral_change < kNone &&
      std::fabs(dihedral_angle_at(f, g, pq) - dihedral_angle_at(made[0], made[1], ba)) >
          bounds.dihedral_change)
    return SwapReason::kDihedralChange;
  if (!(bounds.deviation < kNone)) return SwapReason::kNone;
  const DVec3 between = glm::cross(pq, ba);
  if (std::fabs(glm::dot(points[a] - points[p], between)) > bounds.deviation * glm::length(between))
    return SwapReason::kDeviation;
  return SwapReason::kNone;
}

}  // namespace vkmesh::detail
