#include "mesh/edge_matching.h"

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>

#include <vkmesh/mesh/handles.h>

#include "base/parallel.h"
#include "mesh/edge_records.h"

namespace vkmesh::detail {
namespace {

constexpr std::size_t kGrain = 1 << 14;

// One kind of defect: how many, and a word on the first.
struct Defect {
  std::size_t count = 0;
  std::string first;

  template <class Describe>
  void add(Describe&& describe) {
    if (count++ == 0) first = describe();
  }
  Defect& operator+=(const Defect& later) {
    if (count == 0) first = later.first;
    count += later.count;
    return *this;
  }
};

void append(std::string& sentence, const Defect& defect, const char* one, const char* many) {
  if (defect.count == 0) return;
  if (!sentence.empty()) sentence += ", ";
  sentence += std::to_string(defect.count) + " " + (defect.count == 1 ? one : many) + " (" +
              (defect.count == 1 ? "" : "first: ") + defect.first + ")";
}

std::string edge_name(std::size_t a, std::size_t b) {
  return "points " + std::to_string(a) + " and " + std::to_string(b);
}

// What the edges of some points are.
struct EdgeCounts {
  std::size_t edges = 0, boundary = 0;
  Defect non_manifold, misoriented;

  EdgeCounts& operator+=(const EdgeCounts& later) {
    edges += later.edges;
    boundary += later.boundary;
    non_manifold += later.non_manifold;
    misoriented += later.misoriented;
    return *this;
  }
};

// Counts the edge between the points a and b, and joins its half-edges, the lower halves of `uses`, where
// they are twins.
void pair_edge(std::uint32_t a, std::uint32_t b, std::span<const std::uint64_t> uses,
               std::span<const std::uint32_t> corners, std::span<std::uint32_t> twin, EdgeCounts& counts) {
  ++counts.edges;
  if (uses.size() == 1) {
    ++counts.boundary;
  } else if (uses.size() > 2) {
    counts.non_manifold.add([&] { return edge_name(a, b); });
  } else {
    const auto h = static_cast<std::uint32_t>(uses[0]), g = static_cast<std::uint32_t>(uses[1]);
    if (corners[h] == corners[g]) {
      counts.misoriented.add([&] { return edge_name(a, b); });
    } else {
      twin[h] = g;
      twin[g] = h;
    }
  }
}

// Sorts the records of the points [first, last) and joins the twins among them.
EdgeCounts pair_edges(EdgeRecords& edges, std::span<const std::uint32_t> corners, std::size_t first,
                      std::size_t last, std::span<std::uint32_t> twin) {
  EdgeCounts counts;
  edges.for_each_group(first, last,
                       [&](std::uint32_t a, std::uint32_t b, std::span<const std::uint64_t> uses) {
                         pair_edge(a, b, uses, corners, twin, counts);
                       });
  return counts;
}

// The faces that a walk meets around a vertex, from its leading half-edge.
std::uint32_t fan_size(std::uint32_t leading, std::span<const std::uint32_t> twin,
                       std::span<const std::uint32_t> face_offsets) {
  const auto previous = [&](std::uint32_t h) -> std::uint32_t {
    if (face_offsets.empty()) return h % 3 == 0 ? h + 2 : h - 1;
    const auto next_face = std::upper_bound(face_offsets.begin(), face_offsets.end(), h);
    return h == *(next_face - 1) ? *next_face - 1 : h - 1;
  };
  std::uint32_t met = 0, h = leading;
  do {
    ++met;
    h = twin[previous(h)];
  } while (h != kInvalid && h != leading);
  return met;
}

// How many points are isolated, and how many corners of faces the fans of the others hold.
struct FanCounts {
  std::size_t isolated = 0, met = 0;

  FanCounts& operator+=(const FanCounts& other) {
    isolated += other.isolated;
    met += other.met;
    return *this;
  }
};

// What the pairs of half-edges leave to find. `corners` are those of faces that are not degenerate.
void complete(Matching& matching, std::size_t point_count, std::span<const std::uint32_t> all_corners,
              std::span<const std::uint32_t> corners, std::span<const std::uint32_t> face_offsets,
              const Defect& degenerate, const EdgeCounts& edges) {
  EdgeDefects& defects = matching.defects;
  Defect vertices;
  if (degenerate.count + edges.non_manifold.count + edges.misoriented.count == 0) {
    matching.leading = leading_half_edges(point_count, corners, matching.twin);
    const auto fans = parallel_sum<FanCounts>(point_count, kGrain, [&](std::size_t first, std::size_t last) {
      FanCounts counts;
      for (std::size_t v = first; v < last; ++v) {
        const std::uint32_t h = matching.leading[v];
        if (h == kInvalid)
          ++counts.isolated;
        else
          counts.met += fan_size(h, matching.twin, face_offsets);
      }
      return counts;
    });
    defects.isolated_points = fans.isolated;
    if (fans.met != corners.size()) {
      // Some vertex has faces that its fan does not meet: they form another fan.
      std::vector<std::uint32_t> degree(point_count, 0);
      for (const std::uint32_t c : corners) ++degree[c];
      for (std::size_t v = 0; v < point_count; ++v)
        if (degree[v] != 0 && fan_size(matching.leading[v], matching.twin, face_offsets) != degree[v])
          vertices.add([&] { return "point " + std::to_string(v); });
    }
  } else {
    std::vector<bool> used(point_count, false);
    for (const std::uint32_t c : all_corners) used[c] = true;
    defects.isolated_points = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
  }

  defects.edges = edges.edges;
  defects.boundary_edges = edges.boundary;
  defects.degenerate_faces = degenerate.count;
  defects.non_manifold_edges = edges.non_manifold.count;
  defects.misoriented_edges = edges.misoriented.count;
  defects.non_manifold_vertices = vertices.count;
  append(defects.sentence, degenerate, "degenerate face", "degenerate faces");
  append(defects.sentence, edges.non_manifold, "edge with three or more faces",
         "edges with three or more faces");
  append(defects.sentence, edges.misoriented, "edge whose two faces disagree in orientation",
         "edges whose two faces disagree in orientation");
  append(defects.sentence, vertices, "point where separate fans of faces meet",
         "points where separate fans of faces meet");
}

}  // namespace

std::vector<std::uint32_t> leading_half_edges(std::size_t point_count, std::span<const std::uint32_t> corners,
                                              std::span<const std::uint32_t> twin) {
  std::vector<std::uint32_t> leading(point_count, kInvalid);
  for (std::size_t h = corners.size(); h-- > 0;) leading[corners[h]] = static_cast<std::uint32_t>(h);
  for (std::size_t h = 0; h < corners.size(); ++h)
    if (twin[h] == kInvalid) leading[corners[h]] = static_cast<std::uint32_t>(h);
  return leading;
}

Result<Matching> match_edges(std::size_t point_count, std::span<const std::uint32_t> corners,
                             std::span<const std::uint32_t> face_offsets, Stop* stop) {
  const auto go_on = [&]() -> Result<void> { return stop == nullptr ? Result<void>{} : stop->go_on(); };
  VKMESH_CHECK(check_face_set(point_count, corners, face_offsets));
  const std::size_t face_count = face_offsets.empty() ? corners.size() / 3 : face_offsets.size() - 1;
  const auto face = [&](std::size_t f) {
    return face_offsets.empty() ? corners.subspan(3 * f, 3)
                                : corners.subspan(face_offsets[f], face_offsets[f + 1] - face_offsets[f]);
  };

  Matching matching;
  matching.defects.points = point_count;
  matching.defects.faces = face_count;

  const auto degenerate = parallel_sum<Defect>(face_count, kGrain, [&](std::size_t first, std::size_t last) {
    Defect defect;
    if (!goes_on(stop)) return defect;
    for (std::size_t f = first; f < last; ++f)
      if (is_degenerate(face(f))) defect.add([&] { return "face " + std::to_string(f); });
    return defect;
  });

  VKMESH_CHECK(go_on());
  // Degenerate faces have no part in the surface: the edges are those of the others.
  const std::span<const std::uint32_t> all_corners = corners;
  std::vector<std::uint32_t> sound_corners, sound_offsets = {0};
  if (degenerate.count > 0) {
    for (std::size_t f = 0; f < face_count; ++f) {
      if (is_degenerate(face(f))) continue;
      sound_corners.insert(sound_corners.end(), face(f).begin(), face(f).end());
      sound_offsets.push_back(static_cast<std::uint32_t>(sound_corners.size()));
    }
    corners = sound_corners;
    face_offsets = sound_offsets;
  }
  const std::size_t sound_faces = face_count - degenerate.count;

  matching.twin.assign(corners.size(), kInvalid);
  EdgeCounts edges;
  {
    EdgeRecords records = distribute_edges(point_count, corners, face_offsets, sound_faces, stop);
    VKMESH_CHECK(go_on());
    edges = parallel_sum<EdgeCounts>(point_count, kGrain, [&](std::size_t first, std::size_t last) {
      if (!goes_on(stop)) return EdgeCounts{};
      return pair_edges(records, corners, first, last, matching.twin);
    });
  }
  VKMESH_CHECK(go_on());

  complete(matching, point_count, all_corners, corners, face_offsets, degenerate, edges);
  return matching;
}

Result<Matching> match_merged_edges(Matching before, std::span<const std::uint32_t> point_of,
                                    std::size_t point_count, std::span<const std::uint32_t> corners,
                                    std::span<const std::uint32_t> face_offsets, Stop* stop) {
  const EdgeDefects& defects = before.defects;
  if (defects.degenerate_faces + defects.non_manifold_edges + defects.misoriented_edges > 0)
    return match_edges(point_count, corners, face_offsets, stop);
  std::vector<std::uint8_t> merged(point_count, 0), met(point_count, 0);
  for (const std::uint32_t p : point_of) merged[p] = std::exchange(met[p], 1);

  struct Use {
    std::uint64_t edge, half_edge;
  };
  std::vector<Use> uses;
  EdgeCounts edges{defects.edges, defects.boundary_edges, {}, {}};
  std::size_t paired = 0;
  for (std::size_t f = 0; f < defects.faces; ++f) {
    const std::span<const std::uint32_t> face =
        face_offsets.empty() ? corners.subspan(3 * f, 3)
                             : corners.subspan(face_offsets[f], face_offsets[f + 1] - face_offsets[f]);
    if (std::none_of(face.begin(), face.end(), [&](std::uint32_t p) { return merged[p] != 0; })) continue;
    if (is_degenerate(face)) return match_edges(point_count, corners, face_offsets, stop);
    for_each_edge(corners, face_offsets, f, f + 1, [&](std::uint32_t h, std::uint32_t a, std::uint32_t b) {
      if (merged[a] == 0 && merged[b] == 0) return;
      uses.push_back({std::uint64_t{std::min(a, b)} << 32 | std::max(a, b), h});
      paired += before.twin[h] != kInvalid;
    });
  }
  edges.edges -= uses.size() - paired / 2;
  edges.boundary -= uses.size() - paired;
  for (const Use& use : uses) before.twin[use.half_edge] = kInvalid;
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
    return std::tie(a.edge, a.half_edge) < std::tie(b.edge, b.half_edge);
  });
  std::vector<std::uint64_t> half_edges;
  for (std::size_t i = 0; i < uses.size();) {
    const std::uint64_t edge = uses[i].edge;
    half_edges.clear();
    for (; i < uses.size() && uses[i].edge == edge; ++i) half_edges.push_back(uses[i].half_edge);
    pair_edge(static_cast<std::uint32_t>(edge >> 32), static_cast<std::uint32_t>(edge), half_edges, corners,
              before.twin, edges);
  }
  before.defects.points = point_count;
  before.defects.sentence.clear();
  before.leading.clear();
  complete(before, point_count, corners, corners, face_offsets, {}, edges);
  return before;
}

}  // namespace vkmesh::detail
