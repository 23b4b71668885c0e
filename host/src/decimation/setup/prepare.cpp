#include "decimation/setup/prepare.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "mesh/triangle_half_edges.h"

namespace vkmesh::detail {
namespace {

/// At least so much of the share of vertices that is to be left is left of those that may go.
constexpr double kLeastShare = 0.125;

}  // namespace

bool have_same_values(const DecimateOptions& options, std::uint32_t c, std::uint32_t d) {
  const auto& groups = options.corner_groups;
  if (!groups.empty() && groups[c] != groups[d]) return false;
  return std::all_of(options.attributes.begin(), options.attributes.end(), [&](const DecimateAttribute& a) {
    if (a.corners.empty() || a.corners[c] == a.corners[d]) return true;
    const auto value = [&](std::uint32_t corner) {
      return a.values.subspan(std::size_t{a.corners[corner]} * a.components, a.components);
    };
    return std::ranges::equal(value(c), value(d));
  });
}

void lock_vertices(CollapseMesh& mesh, std::span<const std::uint32_t> corners,
                   const DecimateOptions& options) {
  const DecimateLocks& locks = options.locked;
  if (!locks.vertices.empty() || !locks.edges.empty() || !locks.faces.empty()) {
    std::vector<bool> locked(mesh.apex(), false);
    for (const std::uint32_t v : locks.vertices) locked[v] = true;
    for (const std::uint32_t h : locks.edges)
      for (const std::uint32_t c : {h, next_in_triangle(h)}) locked[corners[c]] = true;
    for (const std::uint32_t f : locks.faces)
      for (std::size_t i = 0; i < 3; ++i) locked[corners[3 * f + i]] = true;
    for (std::uint32_t v = 0; v < mesh.apex(); ++v)
      if (locked[mesh.vertices[v].source]) mesh.vertices[v].source |= VertexRecord::kLocked;
  }
  if (options.curves.boundary != DecimateBoundary::kKept) return;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    for (std::uint32_t h = 4 * f; h < 4 * f + 3; ++h)
      if (mesh.is_ghost(mesh.twin(h))) mesh.vertices[mesh.origin(h)].source |= VertexRecord::kLocked;
}

std::optional<Wedges> find_wedges(CollapseMesh& mesh, std::size_t vertex_count,
                                  const DecimateOptions& options, Stop& stop) {
  if (options.attributes.empty() && options.corner_groups.empty()) return std::nullopt;
  return std::make_optional<Wedges>(
      mesh, vertex_count, [&](std::uint32_t c, std::uint32_t d) { return have_same_values(options, c, d); },
      &stop);
}

ConstraintWeights constraint_weights(const DecimateCurves& curves, const std::optional<Wedges>& wedges) {
  ConstraintWeights weights;
  if (curves.boundary == DecimateBoundary::kInShape)
    weights.boundary = static_cast<float>(curves.boundary_weight);
  if (curves.crease_angle) {
    weights.crease = static_cast<float>(curves.crease_weight);
    weights.crease_cosine = static_cast<float>(std::cos(*curves.crease_angle));
  }
  if (wedges) {
    weights.seam = static_cast<float>(curves.seam_weight);
    weights.wedges = &*wedges;
  }
  return weights;
}

Limits limits_of(const DecimateOptions& options, std::size_t faces, const Frame& frame) {
  Limits limits;
  limits.faces = options.target.faces.value_or(0);
  if (options.target.ratio) {
    const auto share = std::llround(*options.target.ratio * static_cast<double>(faces));
    limits.faces = std::max(limits.faces, static_cast<std::size_t>(share));
  }
  limits.vertices = limits.vertices_asked = options.target.vertices.value_or(0);
  if (options.bounds.error) {
    const double error = frame.scale * options.bounds.error->in_units(frame.diagonal);
    limits.error2 = error * error;
  }
  limits.cos_deviation = static_cast<float>(std::cos(options.bounds.normal_deviation));
  return limits;
}

double share_asked_for(const Limits& limits, std::size_t faces, std::size_t vertices) {
  const auto share = [](std::size_t asked, std::size_t all) {
    return all > 0 ? std::min(1.0, static_cast<double>(asked) / static_cast<double>(all)) : 0.0;
  };
  return std::max(share(limits.faces, faces), share(limits.vertices, vertices));
}

void keep_in_proportion(Limits& limits, double share, std::size_t vertices, std::size_t held) {
  const auto stay = static_cast<double>(std::min(vertices, held));
  const double kept = kLeastShare * share * (static_cast<double>(vertices) - stay);
  if (kept >= 1) limits.vertices = std::max(limits.vertices, static_cast<std::size_t>(stay + kept));
}

double mean_weight_of(const CollapseMesh& mesh) {
  constexpr std::size_t kSample = 4096;
  const std::size_t all = mesh.apex(), count = std::min(all, kSample);
  double sum = 0;
  for (std::uint32_t i = 0; i < count; ++i)
    sum += static_cast<double>(mesh.vertices[count == all ? i : spread_evenly(i, all)].weight);
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

}  // namespace vkmesh::detail
