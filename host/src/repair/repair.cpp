#include "repair/repair.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include <glm/geometric.hpp>

#include <vkmesh/mesh/handles.h>

#include "base/disjoint_sets.h"
#include "mesh/duplicate_faces.h"
#include "mesh/ear_clipper.h"
#include "mesh/edge_records.h"

namespace vkmesh::detail {
namespace {

class Repair {
 public:
  Repair(const IndexedFaceSet& input, ConsolidateReport& report, Stop& stop)
      : input_(input), report_(report), stop_(stop) {
    mesh_.points = input.points;
    mesh_.face_offsets = {0};
  }

  // The steps, in their order.

  /// Takes over every face that has three distinct points.
  void take_faces() {
    std::vector<std::uint32_t> corners;
    for (std::uint32_t f = 0; f < input_.face_count(); ++f) {
      const std::span<const std::uint32_t> face = input_.face(f);
      const std::uint32_t first = input_.is_triangles() ? 3 * f : input_.face_offsets[f];
      corners.clear();
      for (std::uint32_t i = 0; i < face.size(); ++i)
        if (corners.empty() || input_.corners[corners.back()] != face[i]) corners.push_back(first + i);
      while (corners.size() > 1 && input_.corners[corners.back()] == input_.corners[corners.front()])
        corners.pop_back();
      const std::size_t taken = source_face_.size();
      if (corners.size() >= 3) {
        if (repeats_point(corners))
          cut(corners, f);
        else
          take(corners, f);
      }
      if (source_face_.size() == taken)
        ++report_.removed_degenerate_faces;
      else if (corners.size() < face.size() || source_face_.size() > taken + 1)
        ++report_.repaired_polygons;
    }
  }

  void remove_duplicates() {
    const std::vector<DuplicateFace> duplicates = duplicate_faces(mesh_);
    if (duplicates.empty()) return;
    std::vector<std::uint8_t> removed(source_face_.size(), 0);
    std::vector<std::uint32_t> reverses;
    for (std::size_t i = 0; i < duplicates.size();) {
      bool reversed_kept = false;
      std::size_t j = i;
      for (; j < duplicates.size() && duplicates[j].first == duplicates[i].first; ++j) {
        const DuplicateFace& d = duplicates[j];
        if (d.face == d.first) continue;
        if (d.reversed && !std::exchange(reversed_kept, true))
          reverses.push_back(d.face);
        else
          removed[d.face] = 1;
      }
      i = j;
    }
    remove_faces(removed);
    if (reverses.empty()) return;

    // Faces behind removed ones have moved up.
    std::vector<std::uint32_t> place(removed.size());
    for (std::uint32_t f = 0, kept = 0; f < removed.size(); ++f) {
      place[f] = kept;
      kept += removed[f] ? 0u : 1u;
    }
    std::vector<std::uint8_t> one_sided(mesh_.corners.size(), 0);
    for_each_edge_group([&](std::uint32_t a, std::uint32_t, std::span<const std::uint64_t> uses) {
      std::size_t ascending = 0;
      for (const std::uint64_t use : uses)
        ascending += mesh_.corners[static_cast<std::uint32_t>(use)] == a ? 1u : 0u;
      if (2 * ascending != uses.size())
        for (const std::uint64_t use : uses) one_sided[static_cast<std::uint32_t>(use)] = 1;
    });
    removed.assign(source_face_.size(), 0);
    for (const std::uint32_t f : reverses) {
      const std::uint32_t face = place[f];
      for (std::uint32_t h = mesh_.face_offsets[face]; h < mesh_.face_offsets[face + 1]; ++h)
        if (one_sided[h]) removed[face] = 1;
    }
    remove_faces(removed);
  }

  /// Joins the faces of every edge that has two, and collects the edges of three or more.
  void join_edges() {
    face_of_.resize(mesh_.corners.size());
    for (std::uint32_t f = 0; f < source_face_.size(); ++f)
      std::fill(face_of_.begin() + mesh_.face_offsets[f], face_of_.begin() + mesh_.face_offsets[f + 1], f);
    mate_.assign(mesh_.corners.size(), kInvalid);
    for_each_edge_group([&](std::uint32_t, std::uint32_t, std::span<const std::uint64_t> uses) {
      if (uses.size() == 2) {
        join(static_cast<std::uint32_t>(uses[0]), static_cast<std::uint32_t>(uses[1]));
      } else if (uses.size() > 2) {
        std::vector<std::uint32_t>& edge = non_manifold_edges_.emplace_back();
        for (const std::uint64_t use : uses) edge.push_back(static_cast<std::uint32_t>(use));
      }
    });
  }

  /// Decides which faces to flip, one sheet of edge-connected faces after the other.
  Result<void> orient(bool cut_non_orientable) {
    flipped_.assign(source_face_.size(), 0);
    sheet_of_.assign(source_face_.size(), kInvalid);
    std::vector<std::uint32_t> sheet;
    for (std::uint32_t seed = 0; seed < source_face_.size(); ++seed) {
      if (sheet_of_[seed] != kInvalid) continue;
      const auto number = static_cast<std::uint32_t>(sheet_size_.size());
      sheet.assign(1, seed);
      sheet_of_[seed] = number;
      std::size_t flipped = 0;
      bool cut = false;
      for (std::size_t next = 0; next < sheet.size(); ++next) {
        const std::uint32_t f = sheet[next];
        flipped += flipped_[f];
        for (std::uint32_t h = mesh_.face_offsets[f]; h < mesh_.face_offsets[f + 1]; ++h) {
          const std::uint32_t g = mate_[h];
          if (g == kInvalid) continue;
          const std::uint32_t other = face_of_[g];
          const auto wanted = static_cast<std::uint8_t>(flipped_[f] ^ (mesh_.corners[h] == mesh_.corners[g]));
          if (sheet_of_[other] == kInvalid) {
            sheet_of_[other] = number;
            flipped_[other] = wanted;
            sheet.push_back(other);
          } else if (flipped_[other] != wanted) {
            if (!cut_non_orientable)
              return fail(ErrorCode::kUnsuitable, "the component of face " +
                                                      std::to_string(source_face_[seed]) +
                                                      " is not orientable, and is not to be cut");
            unpair(h);
            ++report_.cut_edges;
            cut = true;
          }
        }
      }
      report_.cut_components += cut ? 1u : 0u;
      if (2 * flipped > sheet.size())
        for (const std::uint32_t f : sheet) flipped_[f] ^= 1;
      sheet_size_.push_back(sheet.size());
    }
    return {};
  }

  /// Flips sheets, small ones first, while that gives edges of four, six, … faces more that run opposite
  /// ways: only those can be paired. Each flip lowers the sum of what is in excess, so that it ends.
  void orient_sheets_at_non_manifold_edges() {
    struct Use {
      std::size_t edge;
      int direction;  // the faces that run up the edge, less those that run down
    };
    std::vector<int> excess(non_manifold_edges_.size(), 0);
    std::vector<std::vector<std::uint32_t>> sheets_of_edge(non_manifold_edges_.size());
    std::vector<std::vector<Use>> uses(sheet_size_.size());
    for (std::size_t e = 0; e < non_manifold_edges_.size(); ++e) {
      const std::vector<std::uint32_t>& edge = non_manifold_edges_[e];
      if (edge.size() % 2 != 0) continue;
      for (const std::uint32_t h : edge) {
        const bool ascending = (mesh_.corners[h] < mesh_.corners[next(h)]) != (flipped_[face_of_[h]] != 0);
        const std::uint32_t sheet = sheet_of_[face_of_[h]];
        excess[e] += ascending ? 1 : -1;
        uses[sheet].push_back({e, ascending ? 1 : -1});
        sheets_of_edge[e].push_back(sheet);
      }
    }
    // Uses of one edge by one sheet are one.
    for (std::vector<Use>& of_sheet : uses) {
      std::size_t kept = 0;
      for (const Use& use : of_sheet) {  // edges ascend
        if (kept > 0 && of_sheet[kept - 1].edge == use.edge)
          of_sheet[kept - 1].direction += use.direction;
        else
          of_sheet[kept++] = use;
      }
      of_sheet.resize(kept);
    }

    std::vector<std::uint32_t> waiting(sheet_size_.size());
    std::iota(waiting.begin(), waiting.end(), 0u);
    std::stable_sort(waiting.begin(), waiting.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return sheet_size_[a] < sheet_size_[b]; });
    std::vector<std::uint8_t> flips(sheet_size_.size(), 0);
    for (std::size_t next_sheet = 0; next_sheet < waiting.size(); ++next_sheet) {
      const std::uint32_t sheet = waiting[next_sheet];
      int gain = 0;
      for (const Use& use : uses[sheet])
        gain += std::abs(excess[use.edge]) - std::abs(excess[use.edge] - 2 * use.direction);
      if (gain <= 0) continue;
      flips[sheet] ^= 1;
      for (Use& use : uses[sheet]) {
        excess[use.edge] -= 2 * use.direction;
        use.direction = -use.direction;
        const std::vector<std::uint32_t>& others = sheets_of_edge[use.edge];
        waiting.insert(waiting.end(), others.begin(), others.end());
      }
    }
    for (std::size_t f = 0; f < flipped_.size(); ++f) flipped_[f] ^= flips[sheet_of_[f]];
  }

  /// Chooses which faces stay joined at edges of three or more.
  void pair_faces_at_non_manifold_edges() {
    report_.split_edges = non_manifold_edges_.size();
    for (const std::vector<std::uint32_t>& edge : non_manifold_edges_) pair_up(edge);
  }

  void flip_faces() {
    std::vector<std::uint32_t> mate = mate_;
    for (std::uint32_t f = 0; f < source_face_.size(); ++f) {
      if (!flipped_[f]) continue;
      // The first corner stays the first, so half-edge i becomes the i-th from the end.
      const std::uint32_t begin = mesh_.face_offsets[f], end = mesh_.face_offsets[f + 1];
      for (std::vector<std::uint32_t>* values : {&mesh_.corners, &source_corner_})
        std::reverse(values->begin() + begin + 1, values->begin() + end);
      for (std::uint32_t h = begin; h < end; ++h) mate[flipped_place(h)] = mate_[h];
    }
    for (std::uint32_t& g : mate)
      if (g != kInvalid && flipped_[face_of_[g]]) g = flipped_place(g);
    mate_ = std::move(mate);
    report_.flipped_faces =
        static_cast<std::size_t>(std::count(flipped_.begin(), flipped_.end(), std::uint8_t{1}));
  }

  /// Gives each fan of faces a point of its own.
  void split_points() {
    const std::vector<std::uint32_t> original = mesh_.corners;
    for (bool again = true; again;) {
      again = false;
      name_fans(original);
      // Where one fan meets an edge twice, the edge still has more than two faces: all of these part. Both
      // ends of an open fan may meet in one edge: that closes it.
      for_each_edge_group([&](std::uint32_t, std::uint32_t, std::span<const std::uint64_t> uses) {
        if (uses.size() <= 2) return;
        for (const std::uint64_t use : uses)
          if (mate_[static_cast<std::uint32_t>(use)] != kInvalid) {
            unpair(static_cast<std::uint32_t>(use));
            again = true;
          }
      });
    }
    std::vector<std::uint8_t> copied(input_.points.size(), 0);
    for (std::size_t p = input_.points.size(); p < source_point_.size(); ++p) {
      report_.split_points += copied[source_point_[p]] ? 0u : 1u;
      copied[source_point_[p]] = 1;
    }
    report_.added_points = source_point_.size() - input_.points.size();
    for (std::size_t p = input_.points.size(); p < source_point_.size(); ++p)
      mesh_.points.push_back(input_.points[source_point_[p]]);
  }

  /// Whether the faces are an oriented manifold now.
  Result<bool> done() {
    bool triangles = true;
    for (std::size_t f = 0; f < source_face_.size(); ++f) triangles = triangles && mesh_.face(f).size() == 3;
    // Triangles without offsets: the faces of corners need not be looked up.
    const std::span<const std::uint32_t> offsets = mesh_.face_offsets;
    VKMESH_TRY(matching_, match_edges(mesh_.points.size(), mesh_.corners,
                                      triangles ? offsets.first(0) : offsets, &stop_));
    return matching_.defects.none();
  }

  Repaired finish() {
    mesh_.normalize_offsets();
    source_point_.resize(mesh_.points.size());
    if (report_.added_points == 0) std::iota(source_point_.begin(), source_point_.end(), 0u);
    flipped_.resize(source_face_.size(), 0);
    mesh_.point_channels = gather(input_.point_channels, source_point_);
    mesh_.corner_channels = gather(input_.corner_channels, source_corner_);
    mesh_.face_channels = gather(input_.face_channels, source_face_);
    return {std::move(mesh_), std::move(source_point_), std::move(source_face_), std::move(flipped_),
            std::move(matching_)};
  }

 private:
  template <class Visit>
  void for_each_edge_group(Visit&& visit) {
    EdgeRecords records =
        distribute_edges(named_points(), mesh_.corners, mesh_.face_offsets, source_face_.size());
    records.for_each_group(0, named_points(), visit);
  }
  [[nodiscard]] std::size_t named_points() const {
    return std::max(mesh_.points.size(), source_point_.size());
  }

  bool repeats_point(const std::vector<std::uint32_t>& corners) {
    scratch_.clear();
    for (const std::uint32_t c : corners) scratch_.push_back(input_.corners[c]);
    std::sort(scratch_.begin(), scratch_.end());
    return std::adjacent_find(scratch_.begin(), scratch_.end()) != scratch_.end();
  }

  void take(std::span<const std::uint32_t> corners, std::uint32_t face) {
    for (const std::uint32_t c : corners) {
      mesh_.corners.push_back(input_.corners[c]);
      source_corner_.push_back(c);
    }
    mesh_.face_offsets.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
    source_face_.push_back(face);
  }

  void cut(const std::vector<std::uint32_t>& corners, std::uint32_t face) {
    scratch_.clear();
    for (const std::uint32_t c : corners) scratch_.push_back(input_.corners[c]);
    const auto emit = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
      if (scratch_[i] == scratch_[j] || scratch_[j] == scratch_[k] || scratch_[k] == scratch_[i]) return;
      take(std::array{corners[i], corners[j], corners[k]}, face);
    };
    clipper_.clip(input_.points, scratch_, emit);
  }

  void remove_faces(const std::vector<std::uint8_t>& removed) {
    std::uint32_t corners = 0, faces = 0, begin = 0;
    for (std::uint32_t f = 0; f < removed.size(); ++f) {
      const std::uint32_t end = mesh_.face_offsets[f + 1];
      if (removed[f]) {
        ++report_.removed_duplicate_faces;
      } else {
        for (std::uint32_t c = begin; c < end; ++c, ++corners) {
          mesh_.corners[corners] = mesh_.corners[c];
          source_corner_[corners] = source_corner_[c];
        }
        source_face_[faces] = source_face_[f];
        mesh_.face_offsets[++faces] = corners;
      }
      begin = end;
    }
    mesh_.corners.resize(corners);
    source_corner_.resize(corners);
    source_face_.resize(faces);
    mesh_.face_offsets.resize(faces + 1);
  }

  void join(std::uint32_t h, std::uint32_t g) {
    mate_[h] = g;
    mate_[g] = h;
  }
  void unpair(std::uint32_t h) {
    mate_[mate_[h]] = kInvalid;
    mate_[h] = kInvalid;
  }

  std::uint32_t next(std::uint32_t h) const {
    const std::uint32_t f = face_of_[h];
    return h + 1 == mesh_.face_offsets[f + 1] ? mesh_.face_offsets[f] : h + 1;
  }
  std::uint32_t flipped_place(std::uint32_t h) const {
    const std::uint32_t f = face_of_[h];
    return mesh_.face_offsets[f] + mesh_.face_offsets[f + 1] - 1 - h;
  }

  /// From the edge of half-edge h into its face, square to both the edge and the face's normal. Not unit.
  DVec3 into_face(std::uint32_t h) const {
    const std::uint32_t f = face_of_[h];
    const DVec3 from(mesh_.points[mesh_.corners[h]]);
    DVec3 normal(0.0);
    for (std::uint32_t c = mesh_.face_offsets[f]; c < mesh_.face_offsets[f + 1]; ++c)
      normal += glm::cross(DVec3(mesh_.points[mesh_.corners[c]]) - from,
                           DVec3(mesh_.points[mesh_.corners[next(c)]]) - from);
    return glm::cross(normal, DVec3(mesh_.points[mesh_.corners[next(h)]]) - from);
  }

  struct FaceAtEdge {
    std::uint32_t half_edge;
    double angle;  ///< Around the edge, from its smaller to its larger point, counter-clockwise.
  };

  /// Joins faces of one edge in pairs of opposite direction.
  void pair_up(const std::vector<std::uint32_t>& edge) {
    const std::uint32_t h0 = edge[0];
    const std::uint32_t a = std::min(mesh_.corners[h0], mesh_.corners[next(h0)]);
    const std::uint32_t b = std::max(mesh_.corners[h0], mesh_.corners[next(h0)]);
    const DVec3 axis = DVec3(mesh_.points[b]) - DVec3(mesh_.points[a]);
    DVec3 x(0.0);
    for (const std::uint32_t h : edge)
      if (x == DVec3(0.0)) x = into_face(h);
    const double scale = std::sqrt(glm::dot(axis, axis));
    const DVec3 y = scale > 0 ? glm::cross(axis, x) / scale : DVec3(0.0);

    std::vector<FaceAtEdge> up, down;
    for (const std::uint32_t h : edge) {
      const DVec3 d = into_face(h);
      const bool ascending = (mesh_.corners[h] == a) != (flipped_[face_of_[h]] != 0);
      (ascending ? up : down).push_back({h, std::atan2(glm::dot(d, y), glm::dot(d, x))});
    }
    const bool balanced = up.size() == down.size();
    // The outward normal of an ascending face points to larger angles, that of a descending one to smaller:
    // the solid between them begins at the descending one.
    const auto cost = [&](const FaceAtEdge& ascending, const FaceAtEdge& descending) {
      double wedge = ascending.angle - descending.angle;
      if (wedge <= 0) wedge += 2 * std::numbers::pi;
      return balanced ? wedge : std::abs(wedge - std::numbers::pi);
    };
    while (!up.empty() && !down.empty()) {
      std::size_t best_up = 0, best_down = 0;
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < up.size(); ++i)
        for (std::size_t j = 0; j < down.size(); ++j)
          if (const double c = cost(up[i], down[j]); c < best) {
            best = c;
            best_up = i;
            best_down = j;
          }
      join(up[best_up].half_edge, down[best_down].half_edge);
      up.erase(up.begin() + static_cast<std::ptrdiff_t>(best_up));
      down.erase(down.begin() + static_cast<std::ptrdiff_t>(best_down));
    }
  }

  /// Names the point of every corner: the first fan of a point keeps it, others get new ones.
  void name_fans(const std::vector<std::uint32_t>& original) {
    DisjointSets fans(mesh_.corners.size());
    for (std::uint32_t h = 0; h < mate_.size(); ++h)
      if (const std::uint32_t g = mate_[h]; g != kInvalid && h < g) {
        fans.unite(h, next(g));
        fans.unite(next(h), g);
      }
    source_point_.resize(input_.points.size());
    std::iota(source_point_.begin(), source_point_.end(), 0u);
    std::vector<std::uint8_t> taken(input_.points.size(), 0);
    for (std::uint32_t c = 0; c < mesh_.corners.size(); ++c) {
      const std::uint32_t fan = fans.find(c);
      if (fan != c) {
        mesh_.corners[c] = mesh_.corners[fan];
      } else if (!std::exchange(taken[original[c]], std::uint8_t{1})) {
        mesh_.corners[c] = original[c];
      } else {
        mesh_.corners[c] = static_cast<std::uint32_t>(source_point_.size());
        source_point_.push_back(original[c]);
      }
    }
  }

  const IndexedFaceSet& input_;
  ConsolidateReport& report_;
  Stop& stop_;
  IndexedFaceSet mesh_;  ///< Offsets are kept for triangles as well, until the end.
  std::vector<std::uint32_t> source_point_, source_corner_, source_face_;
  std::vector<std::uint32_t> face_of_;  ///< The face of each corner.
  std::vector<std::uint32_t> mate_;     ///< The half-edge across each one's edge, or kInvalid.
  std::vector<std::vector<std::uint32_t>>
      non_manifold_edges_;  ///< The half-edges of edges of three or more faces.
  std::vector<std::uint8_t> flipped_;
  std::vector<std::uint32_t> sheet_of_;  ///< The sheet of edge-connected faces that each face is of.
  std::vector<std::size_t> sheet_size_;  ///< Its faces.
  Matching matching_;
  EarClipper clipper_;
  std::vector<std::uint32_t> scratch_;
};

}  // namespace

Result<Repaired> repair(const IndexedFaceSet& mesh, bool cut_non_orientable, ConsolidateReport& report,
                        Stop& stop) {
  const auto tick = [&](double done) -> Result<void> {
    stop.report(done);
    return stop.check();
  };
  Repair steps(mesh, report, stop);
  steps.take_faces();
  VKMESH_CHECK(tick(0.2));
  // Most meshes that need repairing at all have a few degenerate faces, and that is all.
  VKMESH_TRY(bool done, steps.done());
  if (done) return steps.finish();
  steps.remove_duplicates();
  VKMESH_CHECK(tick(0.4));
  steps.join_edges();
  VKMESH_CHECK(steps.orient(cut_non_orientable));
  VKMESH_CHECK(tick(0.6));
  steps.orient_sheets_at_non_manifold_edges();
  steps.pair_faces_at_non_manifold_edges();
  steps.flip_faces();
  steps.split_points();
  VKMESH_CHECK(tick(0.9));
  VKMESH_TRY(done, steps.done());
  if (!done) return fail(ErrorCode::kInternal, "repairs left a mesh that is no oriented manifold");
  return steps.finish();
}

}  // namespace vkmesh::detail
