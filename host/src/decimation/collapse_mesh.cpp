#include "decimation/collapse_mesh.h"

#include <algorithm>
#include <numeric>

#include "counting_sort.h"

namespace vkmesh::detail {

/// How the faces around a vertex follow each other. Entry i is about the i-th half-edge that leaves it.
class CollapseMesh::Fan {
 public:
  explicit Fan(std::size_t most) : to_(most), from_(most), clockwise_(most), counter_(most) {}

  /// Takes the vertex that the half-edge leads to, and the one from which the half-edge before it comes.
  void set(std::size_t i, std::uint32_t to, std::uint32_t from) {
    to_[i] = to;
    from_[i] = from;
  }

  /// Finds the half-edges next to each other: where one leads the other's face comes from. Returns false
  /// unless all form one fan.
  bool match(std::size_t count) {
    const std::uint32_t* const to = to_.data();
    const std::uint32_t* const from = from_.data();
    std::uint32_t* const clockwise = clockwise_.data();
    std::uint32_t* const counter = counter_.data();
    std::fill_n(counter, count, kInvalid);
    if (count > kFew) {
      match_many(count);
    } else {
      for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t found = kInvalid;
        for (std::uint32_t j = 0; j < count; ++j) found = from[j] == to[i] ? j : found;
        clockwise[i] = found;
      }
    }
    std::size_t starts = 0;
    std::uint32_t start = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (clockwise[i] == kInvalid) {
        ++starts;
        start = i;
      } else {
        counter[clockwise[i]] = i;
      }
    }
    if (starts > 1) return false;
    std::size_t met = 0;
    std::uint32_t at = start;
    do {
      ++met;
      at = counter[at];
    } while (at != start && at != kInvalid && met < count);
    return met == count && at == (starts == 0 ? start : kInvalid);
  }

  /// The half-edge beyond the face on the right of half-edge i; kInvalid where there is none.
  [[nodiscard]] std::uint32_t clockwise(std::size_t i) const { return clockwise_[i]; }

 private:
  static constexpr std::size_t kFew = 32;

  void match_many(std::size_t count) {
    order_.resize(count);
    std::iota(order_.begin(), order_.end(), 0u);
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return from_[a] != from_[b] ? from_[a] < from_[b] : a < b;
    });
    for (std::size_t i = 0; i < count; ++i) {
      const auto at = std::lower_bound(order_.begin(), order_.end(), to_[i],
                                       [&](std::uint32_t j, std::uint32_t v) { return from_[j] < v; });
      clockwise_[i] = at != order_.end() && from_[*at] == to_[i] ? *at : kInvalid;
    }
  }

  std::vector<std::uint32_t> to_, from_, clockwise_, counter_, order_;
};

bool CollapseMesh::build(std::size_t vertex_count, std::span<const std::uint32_t> corners,
                         std::vector<std::uint32_t>& leading) {
  face_count_ = corners.size() / 3;
  apex_ = static_cast<std::uint32_t>(vertex_count);
  faces_ = LargeArray<Face>(face_count_ + face_count_ / 16 + 64);
  for (std::uint32_t f = 0; f < face_count_; ++f) {
    const std::uint32_t a = corners[3 * f], b = corners[3 * f + 1], c = corners[3 * f + 2];
    if (a == b || b == c || c == a) return false;
    faces_[f] = {{a, b, c}, 0, {}, f};
  }
  // The half-edges that leave each vertex, where the vertices will be: that is memory to be had at no cost.
  constexpr std::size_t kAhead = 64, kWords = sizeof(CollapseVertex) / sizeof(std::uint32_t);
  vertices =
      LargeArray<CollapseVertex>(std::max(vertex_count + 1, (corners.size() + kAhead + kWords - 1) / kWords));
  auto* const leaving = reinterpret_cast<std::uint32_t*>(&vertices[0]);
  for (std::size_t i = 0; i < kAhead; ++i) leaving[corners.size() + i] = 0;
  const std::vector<std::uint32_t> offsets = counting_sort(
      vertex_count, corners.size(), [&](std::size_t c) { return corners[c]; },
      [&](std::size_t slot, std::size_t c) { leaving[slot] = static_cast<std::uint32_t>(c + c / 3); });
  std::size_t most = 0;
  for (std::size_t v = 0; v < vertex_count; ++v)
    most = std::max<std::size_t>(most, offsets[v + 1] - offsets[v]);

  Fan fan(most);
  std::vector<std::uint32_t> boundary;
  leading.assign(vertex_count, kInvalid);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const std::size_t first = offsets[v], count = offsets[v + 1] - first;
    if (count == 0) continue;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t h = leaving[first + i], n = next(h), p = previous(h);
      const std::uint32_t ahead = leaving[first + i + kAhead];
      prefetch(&corners[ahead - ahead / 4]);
      prefetch(&faces_[ahead / 4]);
      fan.set(i, corners[n - n / 4], corners[p - p / 4]);
    }
    if (!fan.match(count)) return false;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t h = leaving[first + i], j = fan.clockwise(i);
      if (j == kInvalid)
        boundary.push_back(h);
      else
        faces_[h >> 2].twin[h & 3u] = previous(leaving[first + j]);
    }
    leading[v] = leaving[first + count - 1];
  }
  return close(boundary);
}

// Puts a ghost, the triangle (target, origin, apex), beyond each boundary edge.
bool CollapseMesh::close(std::span<const std::uint32_t> boundary) {
  const std::size_t all = face_count_ + boundary.size();
  if (all > kMaxFaces) return false;
  if (all > faces_.size()) faces_.grow(all, face_count_);
  auto ghost = static_cast<std::uint32_t>(face_count_);
  std::vector<std::uint32_t> ghost_from(boundary.empty() ? 0 : apex_);  // by vertex: fans are single
  for (const std::uint32_t h : boundary) {
    const std::uint32_t from = origin(h), to = target(h);
    ghost_from[from] = ghost;
    faces_[ghost] = {{to, from, apex_}, 0, {}, kInvalid};
    set_twins(h, 4 * ghost);
    ++ghost;
  }
  // The ghost of v → w arrives from the apex where that of the next edge w → x leaves for it.
  for (auto g = static_cast<std::uint32_t>(face_count_); g < ghost; ++g)
    set_twins(4 * g + 2, 4 * ghost_from[faces_[g].origin[0]] + 1);
  ghosts_ = boundary.size();
  return true;
}

std::array<std::uint32_t, 2> CollapseMesh::fill_hole(std::span<const std::uint32_t> edges,
                                                     std::span<const std::array<std::uint8_t, 3>> triangles) {
  const std::size_t n = edges.size();
  std::array<std::uint32_t, kMostAtHole> vertex, record;
  // By two corners the half-edge that waits for its twin: first what lies around the hole, then edges of
  // triangles whose other side is still to come.
  std::array<std::array<std::uint32_t, kMostAtHole>, kMostAtHole> beyond;
  for (std::size_t i = 0; i < n; ++i) {
    vertex[i] = target(edges[i]);
    record[i] = edges[i] >> 2;
    if (i + 1 < n)
      beyond[i][i + 1] = twin(next(edges[i]));
    else
      beyond[0][i] = twin(next(edges[i]));
  }
  // The faces at an apex are the last two.
  const std::size_t ghost = vertex[n - 1] == apex_ ? n - 1 : kInvalid;
  std::size_t taken = 0;
  for (const auto& [a, b, c] : triangles) {
    const std::uint32_t f = c == ghost ? record[n - 1] : record[taken++], h = 4 * f;
    Face& face = faces_[f];
    face.tags = 0;
    face.origin = {vertex[a], vertex[b], vertex[c]};
    vertices[vertex[a]].leading = h;
    vertices[vertex[b]].leading = h + 1;
    if (c != ghost) vertices[vertex[c]].leading = h + 2;
    set_twins(h + 2, beyond[a][c]);
    if (b == a + 1)
      set_twins(h, beyond[a][b]);
    else
      beyond[a][b] = h;
    if (c == b + 1)
      set_twins(h + 1, beyond[b][c]);
    else
      beyond[b][c] = h + 1;
  }
  const std::array<std::uint32_t, 2> gone = {record[taken], record[ghost == kInvalid ? n - 1 : n - 2]};
  for (const std::uint32_t f : gone) faces_[f].origin[0] = kInvalid;
  return {faces_[gone[0]].source, faces_[gone[1]].source};
}

}  // namespace vkmesh::detail
