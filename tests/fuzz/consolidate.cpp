// Fuzzes consolidate(), diagnose() and validate(): the judgement is that of a slow count, and what is taken
// is a valid mesh that repeats the faces given.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/repair/consolidate.h>

#include "check.h"
#include "face_set.h"

namespace vkmesh::fuzz {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Fans of the faces around vertex v: faces are in one fan when they share an edge that v ends.
std::size_t fans_at(const IndexedFaceSet& mesh, std::uint32_t v) {
  std::vector<std::set<std::uint32_t>> fans;  // The other ends of their edges.
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.face(f);
    const auto place = std::find(corners.begin(), corners.end(), v) - corners.begin();
    if (static_cast<std::size_t>(place) == corners.size()) continue;
    const auto n = corners.size();
    const auto k = static_cast<std::size_t>(place);
    std::set<std::uint32_t> joined = {corners[(k + 1) % n], corners[(k + n - 1) % n]};
    std::erase_if(fans, [&](const std::set<std::uint32_t>& fan) {
      const bool touches =
          std::any_of(fan.begin(), fan.end(), [&](std::uint32_t end) { return joined.contains(end); });
      if (touches) joined.insert(fan.begin(), fan.end());
      return touches;
    });
    fans.push_back(std::move(joined));
  }
  return fans.size();
}

ConsolidateReport slow_survey(const IndexedFaceSet& mesh) {
  ConsolidateReport report;
  report.points = mesh.points.size();
  report.faces = mesh.face_count();
  const std::set<std::uint32_t> used(mesh.corners.begin(), mesh.corners.end());
  report.isolated_points = report.points - used.size();
  std::map<Edge, std::vector<bool>> edges;  // For each face on an edge: whether it runs upwards.
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.face(f);
    const std::set<std::uint32_t> distinct(corners.begin(), corners.end());
    if (corners.size() < 3 || distinct.size() < corners.size()) {
      ++report.degenerate_faces;
      continue;
    }
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t a = corners[k], b = corners[(k + 1) % corners.size()];
      edges[std::minmax(a, b)].push_back(a < b);
    }
  }
  report.edges = edges.size();
  for (const auto& [edge, upwards] : edges) {
    if (upwards.size() == 1) ++report.boundary_edges;
    if (upwards.size() > 2) ++report.non_manifold_edges;
    if (upwards.size() == 2 && upwards[0] == upwards[1]) ++report.misoriented_edges;
  }
  if (report.manifold())
    for (const std::uint32_t v : used)
      if (fans_at(mesh, v) > 1) ++report.non_manifold_vertices;
  return report;
}

void require_same(const ConsolidateReport& report, const ConsolidateReport& slow) {
  require(report.points == slow.points, "points");
  require(report.faces == slow.faces, "faces");
  require(report.isolated_points == slow.isolated_points, "isolated_points");
  require(report.degenerate_faces == slow.degenerate_faces, "degenerate_faces");
  require(report.manifold() == slow.manifold(), "manifold");
  require(report.defects.empty() == report.manifold(), "defects are told when there are some");
  if (slow.degenerate_faces > 0) return;  // What is counted of their edges is not promised.
  require(report.edges == slow.edges, "edges");
  require(report.boundary_edges == slow.boundary_edges, "boundary_edges");
  require(report.non_manifold_edges == slow.non_manifold_edges, "non_manifold_edges");
  require(report.misoriented_edges == slow.misoriented_edges, "misoriented_edges");
  require(report.non_manifold_vertices == slow.non_manifold_vertices, "non_manifold_vertices");
}

void require_valid(const HalfEdgeMesh& mesh) {
  const auto valid = validate(mesh);
  require(valid.has_value(), "valid: " + (valid ? "" : valid.error().describe()));
}

bool same(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

void require_same_counts(const HalfEdgeMesh& mesh, const ConsolidateReport& slow) {
  require(mesh.vertex_count() == slow.points, "vertices are the points");
  require(mesh.face_count() == slow.faces, "faces are the faces");
  require(mesh.edge_count() == slow.edges, "edges are the edges");
  require(mesh.boundary_half_edge_count() == slow.boundary_edges, "boundary edges are the boundary");
}

/// What holds of whatever consolidation makes.
void require_sound(const Consolidated& made, const IndexedFaceSet& input, const ConsolidateReport& slow) {
  require_valid(made.mesh);
  const IndexedFaceSet& mesh = made.face_set;
  require(same(mesh.corners, made.mesh.origins()) && same(mesh.face_offsets, made.mesh.face_offsets()),
          "half-edges are the corners");
  const ConsolidateReport after = slow_survey(mesh);
  require(after.manifold(), "what is made is an oriented manifold");
  require_same_counts(made.mesh, after);
  const ConsolidateReport& report = made.report;
  require(after.points + report.removed_points == slow.points + report.added_points,
          "points are accounted for");
  require(after.faces + report.removed_degenerate_faces + report.removed_duplicate_faces >= slow.faces,
          "faces that are gone are counted");
  require(report.repairs().empty() == slow.manifold() || slow.isolated_points > 0, "repairs are told");

  const auto source = [](const std::vector<std::uint32_t>& sources, std::size_t i) {
    return sources.empty() ? i : sources[i];
  };
  require(made.source_point.empty() || made.source_point.size() == mesh.points.size(), "points have sources");
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    require(mesh.points[i] == input.points.at(source(made.source_point, i)), "points keep their places");
  require(made.source_face.empty() || made.source_face.size() == mesh.face_count(), "faces have sources");
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto from = input.face(source(made.source_face, f));
    for (const std::uint32_t c : mesh.face(f))
      require(std::find(from.begin(), from.end(), source(made.source_point, c)) != from.end(),
              "faces have the corners of their sources");
  }
}

void require_unchanged(const Consolidated& made, const IndexedFaceSet& mesh) {
  require(made.face_set.points == mesh.points && made.face_set.corners == mesh.corners &&
              made.face_set.face_offsets == mesh.face_offsets,
          "an oriented manifold passes unchanged");
  require(made.report.repairs().empty(), "an oriented manifold needs no repairs");
}

void fuzz(std::span<const std::uint8_t> bytes) {
  const IndexedFaceSet mesh = face_set_of(bytes);
  const ConsolidateReport slow = slow_survey(mesh);
  const auto report = diagnose(mesh);
  require(report.has_value(), "any face set is surveyed");
  require_same(*report, slow);

  ConsolidateOptions options;
  options.strict = true;
  const auto taken = consolidate(mesh, options);
  require(taken.has_value() == slow.manifold(), "manifolds are taken, and nothing else");
  if (taken) require_sound(*taken, mesh, slow);
  if (taken) require_unchanged(*taken, mesh);
  if (!taken) require(taken.error().code == ErrorCode::kUnsuitable, "refused as unsuitable");

  for (const bool keep_isolated : {true, false}) {
    options = {};
    options.keep_isolated_points = keep_isolated;
    const auto repaired = consolidate(mesh, options);
    require(repaired.has_value(),
            "any face set is repaired: " + (repaired ? "" : repaired.error().describe()));
    require_sound(*repaired, mesh, slow);
    const auto again = consolidate(repaired->face_set, options);
    require(again.has_value(), "what is repaired is taken");
    require_unchanged(*again, repaired->face_set);
  }
}

}  // namespace
}  // namespace vkmesh::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vkmesh::fuzz::fuzz(std::span(data, size));
  return 0;
}
