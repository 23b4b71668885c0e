#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/repair/consolidate.h>

#include "base/disjoint_sets.h"
#include "base/stop.h"
#include "mesh/edge_matching.h"
#include "mesh/edge_records.h"
#include "repair/repair.h"
#include "repair/weld_boundary.h"

namespace vkmesh {
namespace {

tl::unexpected<Error> not_manifold(const std::string& defects) {
  return fail(ErrorCode::kUnsuitable, "not an oriented manifold mesh: " + defects);
}

ConsolidateReport report_of(detail::EdgeDefects found) {
  ConsolidateReport report;
  report.points = found.points;
  report.faces = found.faces;
  report.edges = found.edges;
  report.boundary_edges = found.boundary_edges;
  report.isolated_points = found.isolated_points;
  report.degenerate_faces = found.degenerate_faces;
  report.non_manifold_edges = found.non_manifold_edges;
  report.misoriented_edges = found.misoriented_edges;
  report.non_manifold_vertices = found.non_manifold_vertices;
  report.defects = std::move(found.sentence);
  return report;
}

/// Flips every face of `faces`; its first corner stays the first.
void flip_faces(IndexedFaceSet& mesh, const std::vector<std::uint8_t>& faces) {
  std::vector<std::uint32_t> source(mesh.corners.size());
  for (std::uint32_t f = 0, c = 0; f < mesh.face_count(); ++f) {
    const std::uint32_t begin = c, size = static_cast<std::uint32_t>(mesh.face(f).size());
    for (std::uint32_t i = 0; i < size; ++i, ++c)
      source[c] = faces[f] && i > 0 ? begin + size - i : begin + i;
  }
  std::vector<std::uint32_t> corners(mesh.corners.size());
  for (std::size_t c = 0; c < corners.size(); ++c) corners[c] = mesh.corners[source[c]];
  mesh.corners = std::move(corners);
  mesh.corner_channels = gather(mesh.corner_channels, source);
}

/// The faces to flip once more, so that in each component the fewer are flipped; where they are as many,
/// those of a closed component that lies inside out.
std::vector<std::uint8_t> faces_to_flip_back(const IndexedFaceSet& mesh, const detail::Matching& matching,
                                             const std::vector<std::uint8_t>& flipped) {
  if (std::find(flipped.begin(), flipped.end(), 1) == flipped.end()) return {};
  const std::size_t faces = mesh.face_count();
  const detail::FaceOfCorner face_of(mesh);
  const auto half_edges = static_cast<std::uint32_t>(mesh.corners.size());
  detail::DisjointSets components(faces);
  for (std::uint32_t h = 0; h < half_edges; ++h)
    if (matching.twin[h] != kInvalid) components.unite(face_of(h), face_of(matching.twin[h]));

  std::vector<std::uint8_t> open(faces, 0);
  std::vector<std::uint32_t> size(faces, 0), flips(faces, 0);
  std::vector<double> volume(faces, 0);
  for (std::uint32_t h = 0; h < half_edges; ++h)
    if (matching.twin[h] == kInvalid) open[components.find(face_of(h))] = 1;
  for (std::uint32_t f = 0; f < faces; ++f) {
    const std::uint32_t root = components.find(f);
    ++size[root];
    flips[root] += flipped[f];
    const auto corners = mesh.face(f);
    // Relative to a point of the component, so that surfaces far from zero keep their digits.
    const DVec3 origin(mesh.points[mesh.face(root)[0]]);
    const DVec3 a = DVec3(mesh.points[corners[0]]) - origin;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
      volume[root] += glm::dot(a, glm::cross(DVec3(mesh.points[corners[i]]) - origin,
                                             DVec3(mesh.points[corners[i + 1]]) - origin));
  }
  std::vector<std::uint8_t> back(faces, 0);
  for (std::uint32_t f = 0; f < faces; ++f) {
    const std::uint32_t root = components.find(f);
    const std::uint32_t rest = size[root] - flips[root];
    back[f] = flips[root] > rest || (flips[root] == rest && !open[root] && volume[root] < 0);
  }
  return back;
}

void drop_isolated_points(Consolidated& result) {
  IndexedFaceSet& mesh = result.face_set;
  std::vector<std::uint32_t> number(mesh.points.size(), kInvalid), kept;
  for (const std::uint32_t c : mesh.corners) number[c] = 0;
  for (std::uint32_t p = 0; p < number.size(); ++p) {
    if (number[p] == kInvalid) continue;
    number[p] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(p);
  }
  result.report.removed_points = mesh.points.size() - kept.size();
  if (result.report.removed_points == 0) return;
  for (std::uint32_t& c : mesh.corners) c = number[c];
  std::vector<Vec3> points;
  std::vector<std::uint32_t> source;
  for (const std::uint32_t p : kept) {
    points.push_back(mesh.points[p]);
    source.push_back(result.source_point.empty() ? p : result.source_point[p]);
  }
  mesh.points = std::move(points);
  mesh.point_channels = gather(mesh.point_channels, kept);
  result.source_point = std::move(source);
}

/// Maps welded point indices back to input indices.
void name_before_welding(std::vector<std::uint32_t>& source_point, const std::vector<std::uint32_t>& point_of,
                         std::size_t points) {
  std::vector<std::uint32_t> first(points, kInvalid);
  for (std::uint32_t p = 0; p < point_of.size(); ++p) first[point_of[p]] = std::min(first[point_of[p]], p);
  if (source_point.empty())
    source_point = std::move(first);
  else
    for (std::uint32_t& p : source_point) p = first[p];
}

Result<detail::Matching> match(const IndexedFaceSet& mesh, detail::Stop* stop = nullptr) {
  return detail::match_edges(mesh.points.size(), mesh.corners, mesh.face_offsets, stop);
}

Result<Consolidated> run(IndexedFaceSet mesh, const ConsolidateOptions& options, const Progress& progress) {
  detail::Stop stop(progress, detail::Stop::Clock::now(), std::numeric_limits<double>::infinity());
  const auto tick = [&](double done) -> Result<void> {
    stop.report(done);
    if (!stop.is_cancelled()) return {};
    return fail(ErrorCode::kInterrupted, "consolidation was interrupted");
  };
  VKMESH_CHECK(tick(0));
  Consolidated result;
  Welded welded;
  if (options.weld) {
    VKMESH_TRY(welded, detail::weld(mesh, *options.weld, &stop));
    mesh = std::move(welded.mesh);
    VKMESH_CHECK(tick(0.05));
  }
  VKMESH_TRY(detail::Matching matching, match(mesh, &stop));
  if (options.weld_boundary && !options.weld && matching.defects.boundary_edges > 0) {
    VKMESH_TRY(welded, detail::weld_boundary(mesh, matching.twin, &stop));
    if (welded.merged_points > 0) {
      mesh = std::move(welded.mesh);
      VKMESH_TRY(matching,
                 detail::match_merged_edges(std::move(matching), welded.point_of, mesh.points.size(),
                                            mesh.corners, mesh.face_offsets, &stop));
    }
  }
  VKMESH_CHECK(tick(0.1));
  ConsolidateReport& report = result.report = report_of(std::move(matching.defects));
  if (welded.merged_points > 0) {
    report.welded_points = welded.merged_points;
    report.largest_weld_move = welded.largest_move;
    report.weld_seams = std::move(welded.seams);
  }
  if (report.manifold()) {
    result.face_set = std::move(mesh);
  } else if (options.strict) {
    return not_manifold(report.defects);
  } else {
    VKMESH_TRY(detail::Repaired repaired, detail::repair(mesh, options.cut_non_orientable, report, stop));
    mesh = {};
    result.face_set = std::move(repaired.mesh);
    result.source_point = std::move(repaired.source_point);
    result.source_face = std::move(repaired.source_face);
    report.non_manifold_vertices = std::max(report.non_manifold_vertices, report.split_points);
    matching = std::move(repaired.matching);
    const std::vector<std::uint8_t> back = faces_to_flip_back(result.face_set, matching, repaired.flipped);
    if (std::find(back.begin(), back.end(), 1) != back.end()) {
      flip_faces(result.face_set, back);
      for (std::size_t f = 0; f < back.size(); ++f) {
        if (!back[f]) continue;
        report.flipped_faces += repaired.flipped[f] ? std::size_t(-1) : std::size_t{1};
      }
      VKMESH_TRY(matching, match(result.face_set, &stop));
    }
  }
  if (!options.keep_isolated_points) {
    drop_isolated_points(result);
    if (report.removed_points > 0) {
      VKMESH_TRY(matching, match(result.face_set, &stop));
    }
  }
  if (report.welded_points > 0) name_before_welding(result.source_point, welded.point_of, report.points);
  result.mesh = HalfEdgeMesh::from_arrays(result.face_set.corners, std::move(matching.twin),
                                          std::move(matching.leading), result.face_set.face_offsets);
  VKMESH_CHECK(tick(1));
  return result;
}

}  // namespace

std::vector<std::string> ConsolidateReport::repairs() const {
  std::vector<std::string> sentences;
  const auto say = [&](std::size_t count, const char* one, const char* many, const std::string& rest) {
    if (count > 0) sentences.push_back(std::to_string(count) + " " + (count == 1 ? one : many) + " " + rest);
  };
  say(welded_points, "point", "points", "welded to others");
  for (const std::string& name : weld_seams)
    sentences.push_back("the values of '" + name +
                        "' moved from points to corners, for points that were welded differ");
  say(removed_degenerate_faces, "face", "faces", "without three distinct points removed");
  say(removed_duplicate_faces, "face", "faces", "with the points of another removed");
  say(repaired_polygons, "polygon", "polygons", "that repeated a point repaired");
  say(flipped_faces, "face", "faces", "flipped to agree in orientation");
  say(cut_components, "component", "components",
      std::string("not orientable, cut along ") + std::to_string(cut_edges) +
          (cut_edges == 1 ? " edge" : " edges"));
  say(split_edges, "edge", "edges", "of three or more faces split");
  say(split_points, "point", "points",
      std::string("where separate fans of faces met split, ") + std::to_string(added_points) +
          (added_points == 1 ? " copy" : " copies") + " added");
  say(removed_points, "isolated point", "isolated points", "removed");
  return sentences;
}

Result<Consolidated> consolidate(IndexedFaceSet mesh, const ConsolidateOptions& options,
                                 const Progress& progress) {
  return detail::catching([&] { return run(std::move(mesh), options, progress); });
}

Result<ConsolidateReport> diagnose(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<ConsolidateReport> {
    VKMESH_TRY(detail::Matching matching, match(mesh));
    return report_of(std::move(matching.defects));
  });
}

Result<HalfEdgeMesh> to_half_edge_mesh(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<HalfEdgeMesh> {
    VKMESH_TRY(detail::Matching matching, match(mesh));
    if (!matching.defects.none()) return not_manifold(matching.defects.sentence);
    return HalfEdgeMesh::from_arrays(mesh.corners, std::move(matching.twin), std::move(matching.leading),
                                     mesh.face_offsets);
  });
}

Result<IndexedFaceSet> to_indexed_face_set(const HalfEdgeMesh& mesh, std::vector<Vec3> positions) {
  return detail::catching([&]() -> Result<IndexedFaceSet> {
    if (positions.size() != mesh.vertex_count())
      return fail(ErrorCode::kUsage, std::to_string(positions.size()) + " positions for " +
                                         std::to_string(mesh.vertex_count()) + " vertices");
    IndexedFaceSet set;
    set.points = std::move(positions);
    set.corners.assign(mesh.origins().begin(), mesh.origins().end());
    set.face_offsets.assign(mesh.face_offsets().begin(), mesh.face_offsets().end());
    return set;
  });
}

}  // namespace vkmesh
