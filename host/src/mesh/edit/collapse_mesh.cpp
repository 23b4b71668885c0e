#include "mesh/edit/collapse_mesh.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <numeric>

#include "base/parallel.h"

namespace vkmesh::detail {

/// How the faces around a vertex follow each other. Entry i is about the i-th half-edge that leaves it.
class CollapseMesh::Fan {
 public:
  explicit Fan(std::size_t most) : to_(most), from_(most), clockwise_(most) {}

  /// Takes the vertex that the half-edge leads to, and the one from which the half-edge before it comes.
  void set(std::size_t i, std::uint32_t to, std::uint32_t from) {
    to_[i] = to;
    from_[i] = from;
  }

  /// Finds the half-edges next to each other: where one leads the other's face comes from. Returns false
  /// unless all form one fan.
  bool match(std::size_t count) {
    if (count > kFew)
      match_many(count);
    else
      match_few(count);
    std::uint32_t* const clockwise = clockwise_.data();
    const std::size_t ends =
        static_cast<std::size_t>(std::count(clockwise, clockwise + count, std::uint32_t{kInvalid}));
    if (ends > 1) return false;
    // The last goes clockwise to the first: the fan is closed for the time being.
    std::uint32_t last = 0;
    if (ends == 1) {
      last = static_cast<std::uint32_t>(std::find(clockwise, clockwise + count, std::uint32_t{kInvalid}) -
                                        clockwise);
      std::uint64_t sum = 0;  // of all but the first
      for (std::size_t i = 0; i < count; ++i) sum += i != last ? clockwise[i] : 0;
      const std::uint64_t first = std::uint64_t{count} * (count - 1) / 2 - sum;
      if (first >= count) return false;
      clockwise[last] = static_cast<std::uint32_t>(first);
    }
    bool early = false;
    std::uint32_t at = last;
    for (std::size_t i = 1; i < count; ++i) {
      at = clockwise[at];
      early |= at == last;
    }
    const bool one = !early && clockwise[at] == last;
    if (ends == 1) clockwise[last] = kInvalid;
    return one;
  }

  /// The half-edge beyond the face on the right of half-edge i; kInvalid where there is none.
  [[nodiscard]] std::uint32_t clockwise(std::size_t i) const { return clockwise_[i]; }

 private:
  static constexpr std::size_t kFew = 32;

  // By a table of the low bits of `from`; what others have overwritten is looked for.
  void match_few(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) table_[from_[i] % kTable] = static_cast<std::uint8_t>(i);
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t found = table_[to_[i] % kTable];
      if (found >= count || from_[found] != to_[i]) {
        found = kInvalid;
        for (std::uint32_t j = 0; j < count; ++j) found = from_[j] == to_[i] ? j : found;
      }
      clockwise_[i] = found;
    }
  }

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

  static constexpr std::uint32_t kTable = 256;
  std::array<std::uint8_t, kTable> table_{};
  std::vector<std::uint32_t> to_, from_, clockwise_, order_;
};

/// The same for a few half-edges around an inner vertex, unrolled for each number of them: a loop whose end
/// is unpredictable costs more than its body.
class CollapseMesh::SmallFan {
 public:
  /// Sets the twins of the half-edges before these if they are found to form one closed fan, which they may
  /// be even so.
  bool join(LargeArray<Face>& faces, std::span<const std::uint32_t> leaving) {
    switch (leaving.size()) {
      case 3:
        return join_exactly<3>(faces, leaving.data());
      case 4:
        return join_exactly<4>(faces, leaving.data());
      case 5:
        return join_exactly<5>(faces, leaving.data());
      case 6:
        return join_exactly<6>(faces, leaving.data());
      case 7:
        return join_exactly<7>(faces, leaving.data());
      case 8:
        return join_exactly<8>(faces, leaving.data());
      default:
        return false;
    }
  }

 private:
  template <std::uint32_t kCount>
  bool join_exactly(LargeArray<Face>& faces, const std::uint32_t* leaving) {
    std::array<std::uint32_t, kMaxEdges> to, from, before, clockwise;
    std::fill(from.begin() + kCount, from.end(), kInvalid);  // of no half-edge
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const std::uint32_t h = leaving[i], corner = h & 3u;
      const Face& face = faces[h >> 2];
      to[i] = face.origin[CollapseMesh::kNextCorner[corner]];
      from[i] = face.origin[CollapseMesh::kPreviousCorner[corner]];
      before[i] = (h & ~3u) | CollapseMesh::kPreviousCorner[corner];
      table_[from[i] % kTable] = static_cast<std::uint8_t>(i);
    }
    std::uint32_t different = 0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      clockwise[i] = table_[to[i] % kTable] % kMaxEdges;
      different |= from[clockwise[i]] ^ to[i];
    }
    // All are found, and going on from one comes by all.
    if (different != 0) return false;
    std::uint32_t seen = 0, at = 0;
    for (std::uint32_t k = 0; k < kCount; ++k) {
      seen |= 1u << at;
      at = clockwise[at];
    }
    if (seen != (1u << kCount) - 1) return false;
    for (std::uint32_t i = 0; i < kCount; ++i)
      faces[leaving[i] >> 2].twin[leaving[i] & 3u] = before[clockwise[i]];
    return true;
  }

  static constexpr std::uint32_t kMaxEdges = 8, kTable = 256;
  std::array<std::uint8_t, kTable> table_{};  // by the low bits of `from`
};

bool CollapseMesh::connect(std::size_t vertex_count, std::vector<std::uint32_t>& leading) {
  constexpr std::size_t kGrain = 1 << 14;
  const std::size_t corners = 3 * face_count_;
  // The half-edges that leave each vertex, where the vertices will be: that is memory to be had at no cost.
  constexpr std::size_t kUsual = 6, kAhead = 64, kTail = kAhead + kUsual;  // what most vertices have
  constexpr std::size_t kWords = sizeof(VertexRecord) / sizeof(std::uint32_t);
  vertices = LargeArray<VertexRecord>(std::max(vertex_count + 1, (corners + kTail + kWords - 1) / kWords));
  auto* const leaving = reinterpret_cast<std::uint32_t*>(&vertices[0]);
  for (std::size_t i = 0; i < kTail; ++i) leaving[corners + i] = 0;
  std::vector<std::uint32_t> ends(vertex_count, 0);  // where those of each vertex begin, and then end
  ranges_.for_each([&](const VertexRanges::Range& range) {
    range.for_each_face([&](std::uint32_t f) {
      prefetch_stream(&faces_[f]);
      for (const std::uint32_t v : faces_[f].origin)
        if (range.has(v)) ++ends[v];
    });
  });
  std::size_t most = 0;
  std::uint32_t sum = 0;
  for (std::uint32_t& end : ends) {
    const std::uint32_t count = end;
    most = std::max<std::size_t>(most, count);
    end = sum;
    sum += count;
  }
  ranges_.for_each([&](const VertexRanges::Range& range) {
    range.for_each_face([&](std::uint32_t f) {
      prefetch_stream(&faces_[f]);
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t v = faces_[f].origin[i];
        if (range.has(v)) leaving[ends[v]++] = 4 * f + i;
      }
    });
  });

  leading.resize(vertex_count);
  struct Fans {
    std::vector<std::uint32_t> boundary;
    bool single = true;
    Fans& operator+=(const Fans& after) {
      boundary.insert(boundary.end(), after.boundary.begin(), after.boundary.end());
      single &= after.single;
      return *this;
    }
  };
  const auto fans = parallel_sum<Fans>(vertex_count, kGrain, [&](std::size_t begin, std::size_t end) {
    Fans found;
    Fan fan(most);
    SmallFan small_fan;
    std::size_t first = begin == 0 ? 0 : ends[begin - 1];
    for (std::size_t v = begin; v < end && found.single; first = ends[v++]) {
      const std::size_t count = ends[v] - first;
      const std::uint32_t* const at = leaving + first;
      leading[v] = count == 0 ? kInvalid : at[count - 1];
      for (std::size_t i = 0; i < kUsual; ++i) prefetch(&faces_[at[kAhead + i] / 4]);
      if (count == 0 || small_fan.join(faces_, {at, count})) continue;
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t n = next(at[i]), p = previous(at[i]);
        fan.set(i, origin(n), origin(p));
      }
      found.single = fan.match(count);
      for (std::size_t i = 0; i < count && found.single; ++i) {
        if (const std::uint32_t j = fan.clockwise(i); j == kInvalid)
          found.boundary.push_back(at[i]);
        else
          faces_[at[i] >> 2].twin[at[i] & 3u] = previous(at[j]);
      }
    }
    return found;
  });
  if (!fans.single) return false;
  const std::vector<std::uint32_t>& boundary = fans.boundary;
  return close(boundary);
}

// Puts a ghost, the triangle (target, origin, apex), beyond each boundary edge; these in the order of their
// origins, of which none comes twice.
bool CollapseMesh::close(std::span<const std::uint32_t> boundary) {
  const std::size_t all = face_count_ + boundary.size();
  if (all > kMaxFaces) return false;
  if (all > faces_.size()) faces_.grow(all, face_count_);
  auto ghost = static_cast<std::uint32_t>(face_count_);
  for (const std::uint32_t h : boundary) {
    const std::uint32_t from = origin(h), to = target(h);
    faces_[ghost] = {{to, from, apex_}, 0, {}, kInvalid};
    set_twins(h, 4 * ghost);
    ++ghost;
  }
  // The ghost of v → w arrives from the apex where that of the next edge w → x leaves for it.
  for (auto g = static_cast<std::uint32_t>(face_count_); g < ghost; ++g) {
    const auto next = std::ranges::lower_bound(boundary, faces_[g].origin[0], {},
                                               [this](std::uint32_t h) { return origin(h); });
    const auto its_ghost =
        static_cast<std::uint32_t>(face_count_) + static_cast<std::uint32_t>(next - boundary.begin());
    set_twins(4 * g + 2, 4 * its_ghost + 1);
  }
  ghosts_ = boundary.size();
  return true;
}

std::array<std::uint32_t, 2> CollapseMesh::fill_hole(std::span<const std::uint32_t> edges,
                                                     std::span<const std::array<std::uint8_t, 3>> triangles,
                                                     std::size_t first) {
  const std::size_t n = edges.size();
  std::array<std::uint32_t, kMaxHoleEdges> vertex, record;
  // By two corners the half-edge that waits for its twin: first what lies around the hole, then edges of
  // triangles whose other side is still to come.
  std::array<std::array<std::uint32_t, kMaxHoleEdges>, kMaxHoleEdges> beyond;
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
  std::size_t taken = first;
  for (const auto& [a, b, c] : triangles) {
    const std::uint32_t f = c == ghost ? record[n - 1] : record[taken], h = 4 * f;
    if (c != ghost) taken = taken + 2 < n ? taken + 1 : 0;
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
  for (const std::uint32_t f : gone) remove(f);
  return {faces_[gone[0]].source, faces_[gone[1]].source};
}

}  // namespace vkmesh::detail
