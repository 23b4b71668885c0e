#include "edge_matching.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>

#include <vkmesh/handles.h>

#include "parallel.h"

namespace vkmesh::detail {
namespace {

// Stands for the other end of an edge that joins a point to itself: such edges take no part.
constexpr std::uint32_t kLoop = kInvalid;

Result<void> check_input(std::size_t point_count, std::span<const std::uint32_t> corners,
                         std::span<const std::uint32_t> offsets) {
  if (corners.size() >= kInvalid || point_count >= kInvalid)
    return fail(ErrorCode::kUnsuitable, "the mesh has more than 2^32 - 2 corners or points");
  if (offsets.empty() && corners.size() % 3 != 0)
    return fail(ErrorCode::kUsage, "a triangle list must have a multiple of three corners, not " +
                                       std::to_string(corners.size()));
  if (!offsets.empty()) {
    if (offsets.front() != 0 || offsets.back() != corners.size() ||
        !std::is_sorted(offsets.begin(), offsets.end()))
      return fail(ErrorCode::kUsage, "face offsets must ascend from 0 to the number of corners");
  }
  std::uint32_t largest = 0;
  for (const std::uint32_t c : corners) largest = std::max(largest, c);
  if (!corners.empty() && largest >= point_count)
    return fail(ErrorCode::kUsage, "a face names point " + std::to_string(largest) + ", but there are " +
                                       std::to_string(point_count) + " points");
  return {};
}

// Calls visit(half-edge, from, to) for each edge of the faces [first, last), in order.
template <class Visit>
void for_each_edge(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> offsets,
                   std::size_t first, std::size_t last, Visit&& visit) {
  if (offsets.empty()) {
    for (auto h = static_cast<std::uint32_t>(3 * first); h < 3 * last; h += 3) {
      const std::uint32_t a = corners[h], b = corners[h + 1], c = corners[h + 2];
      visit(h, a, b);
      visit(h + 1, b, c);
      visit(h + 2, c, a);
    }
  } else {
    for (std::size_t f = first; f < last; ++f)
      for (std::uint32_t h = offsets[f]; h < offsets[f + 1]; ++h)
        visit(h, corners[h], corners[h + 1 == offsets[f + 1] ? offsets[f] : h + 1]);
  }
}

bool is_degenerate(std::span<const std::uint32_t> face) {
  if (face.size() < 3) return true;
  if (face.size() == 3) return face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
  std::vector<std::uint32_t> sorted(face.begin(), face.end());
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
}

// Sorts the records of one point. Most points have eight or fewer (six on a regular mesh), and a branch on
// the data costs more than the rest, so these pass through Batcher's odd-even merge network.
template <class Iterator>
void sort_records(Iterator begin, Iterator end) {
  const auto size = static_cast<std::size_t>(end - begin);
  if (size > 8) {
    std::sort(begin, end);
    return;
  }
  std::array<std::uint64_t, 8> r;
  for (std::size_t i = 0; i < 8; ++i)
    r[i] = i < size ? begin[static_cast<std::ptrdiff_t>(i)] : std::numeric_limits<std::uint64_t>::max();
  const auto order = [&](std::size_t i, std::size_t j) {
    const std::uint64_t x = r[i], y = r[j];
    r[i] = x < y ? x : y;
    r[j] = x < y ? y : x;
  };
  order(0, 1), order(2, 3), order(4, 5), order(6, 7);
  order(0, 2), order(1, 3), order(4, 6), order(5, 7);
  order(1, 2), order(5, 6);
  order(0, 4), order(1, 5), order(2, 6), order(3, 7);
  order(2, 4), order(3, 5);
  order(1, 2), order(3, 4), order(5, 6);
  for (std::size_t i = 0; i < size; ++i) begin[static_cast<std::ptrdiff_t>(i)] = r[i];
}

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

// The records of all edges, those of each point side by side.
struct EdgeRecords {
  std::vector<std::uint64_t> records;
  std::vector<std::uint32_t> end;  // of the records of each point: where those of the next begin
};

// A record for each edge of each face, distributed by its smaller point (a counting sort): the larger point
// above, the half-edge below, so that the plain order of the 64-bit words is the order wanted. Two blocks of
// faces count and place at once, the second behind the first within each point; more would cost more memory
// than they save time.
EdgeRecords distribute_edges(std::size_t point_count, std::span<const std::uint32_t> corners,
                             std::span<const std::uint32_t> face_offsets, std::size_t face_count) {
  constexpr std::size_t kBlocks = 2;
  EdgeRecords result{std::vector<std::uint64_t>(corners.size()), std::vector<std::uint32_t>(point_count)};
  std::array<std::vector<std::uint32_t>, kBlocks> slots;
  const auto for_each_block = [&](auto&& body) {
    parallel_ranges(kBlocks, 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t b = first; b < last; ++b)
        for_each_edge(corners, face_offsets, face_count * b / kBlocks, face_count * (b + 1) / kBlocks,
                      body(b));
    });
  };
  for_each_block([&](std::size_t b) {
    slots[b].assign(point_count, 0);
    return [slot = slots[b].data()](std::uint32_t, std::uint32_t from, std::uint32_t to) {
      ++slot[std::min(from, to)];
    };
  });
  std::uint32_t placed = 0;
  for (std::size_t a = 0; a < point_count; ++a) {
    for (std::vector<std::uint32_t>& slot : slots) placed += std::exchange(slot[a], placed);
    result.end[a] = placed;
  }
  for_each_block([&](std::size_t b) {
    return [slot = slots[b].data(), records = result.records.data()](std::uint32_t h, std::uint32_t from,
                                                                     std::uint32_t to) {
      const std::uint32_t other = from == to ? kLoop : std::max(from, to);
      records[slot[std::min(from, to)]++] = std::uint64_t{other} << 32 | h;
    };
  });
  return result;
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

// Sorts the records of the points [first, last) and joins the twins among them.
EdgeCounts pair_edges(EdgeRecords& edges, std::span<const std::uint32_t> corners, std::size_t first,
                      std::size_t last, std::span<std::uint32_t> twin) {
  EdgeCounts counts;
  for (std::size_t a = first; a < last; ++a) {
    const auto begin = edges.records.begin() + (a == 0 ? 0 : edges.end[a - 1]);
    const auto end = edges.records.begin() + edges.end[a];
    sort_records(begin, end);
    for (auto i = begin; i != end;) {
      const auto b = static_cast<std::uint32_t>(*i >> 32);
      if (b == kLoop) break;
      auto j = i + 1;
      while (j != end && *j >> 32 == b) ++j;
      ++counts.edges;
      const auto h = static_cast<std::uint32_t>(*i);
      if (j - i == 1) {
        ++counts.boundary;
      } else if (j - i > 2) {
        counts.non_manifold.add([&] { return edge_name(a, b); });
      } else {
        const auto g = static_cast<std::uint32_t>(*(i + 1));
        if (corners[h] == corners[g]) {
          counts.misoriented.add([&] { return edge_name(a, b); });
        } else {
          twin[h] = g;
          twin[g] = h;
        }
      }
      i = j;
    }
  }
  return counts;
}

// On the boundary the half-edge without a twin, elsewhere the first.
std::vector<std::uint32_t> leading_half_edges(std::size_t point_count, std::span<const std::uint32_t> corners,
                                              std::span<const std::uint32_t> twin) {
  std::vector<std::uint32_t> leading(point_count, kInvalid);
  for (std::size_t h = corners.size(); h-- > 0;) leading[corners[h]] = static_cast<std::uint32_t>(h);
  for (std::size_t h = 0; h < corners.size(); ++h)
    if (twin[h] == kInvalid) leading[corners[h]] = static_cast<std::uint32_t>(h);
  return leading;
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

}  // namespace

Result<Matching> match_edges(std::size_t point_count, std::span<const std::uint32_t> corners,
                             std::span<const std::uint32_t> face_offsets) {
  constexpr std::size_t kGrain = 1 << 14;
  VKMESH_CHECK(check_input(point_count, corners, face_offsets));
  const std::size_t face_count = face_offsets.empty() ? corners.size() / 3 : face_offsets.size() - 1;
  const auto face = [&](std::size_t f) {
    return face_offsets.empty() ? corners.subspan(3 * f, 3)
                                : corners.subspan(face_offsets[f], face_offsets[f + 1] - face_offsets[f]);
  };

  Matching matching;
  ConsolidateReport& report = matching.report;
  report.points = point_count;
  report.faces = face_count;

  Defect torn;
  const auto degenerate = parallel_sum<Defect>(face_count, kGrain, [&](std::size_t first, std::size_t last) {
    Defect defect;
    for (std::size_t f = first; f < last; ++f)
      if (is_degenerate(face(f))) defect.add([&] { return "face " + std::to_string(f); });
    return defect;
  });

  matching.twin.assign(corners.size(), kInvalid);
  EdgeCounts edges;
  {
    EdgeRecords records = distribute_edges(point_count, corners, face_offsets, face_count);
    edges = parallel_sum<EdgeCounts>(point_count, kGrain, [&](std::size_t first, std::size_t last) {
      return pair_edges(records, corners, first, last, matching.twin);
    });
  }

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
    report.isolated_points = fans.isolated;
    if (fans.met != corners.size()) {
      // Some vertex has faces that its fan does not meet: they form another fan.
      std::vector<std::uint32_t> degree(point_count, 0);
      for (const std::uint32_t c : corners) ++degree[c];
      for (std::size_t v = 0; v < point_count; ++v)
        if (degree[v] != 0 && fan_size(matching.leading[v], matching.twin, face_offsets) != degree[v])
          torn.add([&] { return "point " + std::to_string(v); });
    }
  } else {
    std::vector<bool> used(point_count, false);
    for (const std::uint32_t c : corners) used[c] = true;
    report.isolated_points = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
  }

  report.edges = edges.edges;
  report.boundary_edges = edges.boundary;
  report.degenerate_faces = degenerate.count;
  report.non_manifold_edges = edges.non_manifold.count;
  report.misoriented_edges = edges.misoriented.count;
  report.non_manifold_vertices = torn.count;
  append(report.defects, degenerate, "degenerate face", "degenerate faces");
  append(report.defects, edges.non_manifold, "edge with three or more faces",
         "edges with three or more faces");
  append(report.defects, edges.misoriented, "edge whose two faces disagree in orientation",
         "edges whose two faces disagree in orientation");
  append(report.defects, torn, "point where separate fans of faces meet",
         "points where separate fans of faces meet");
  return matching;
}

}  // namespace vkmesh::detail
