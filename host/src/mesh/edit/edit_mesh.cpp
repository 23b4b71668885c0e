#include "mesh/edit/edit_mesh.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "base/stop.h"

namespace vkmesh::detail {

/// How the faces around a vertex follow each other. Entry i is about the i-th half-edge that leaves it.
class EditFaces::Fan {
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

bool EditFaces::connect(std::size_t vertex_count, std::vector<std::uint32_t>& leading,
                        std::uint32_t* const leaving, Stop* stop) {
  constexpr std::size_t kGrain = 1 << 14;
  const std::size_t corners = 3 * face_count_;
  // `leaving`: the half-edges that leave each vertex, then what is read ahead of them.
  constexpr std::size_t kUsual = 6, kAhead = 64;  // what most vertices have
  static_assert(kScratchTail == kAhead + kUsual);
  for (std::size_t i = 0; i < kScratchTail; ++i) leaving[corners + i] = 0;
  std::vector<std::uint32_t> ends(vertex_count, 0);  // where those of each vertex begin, and then end
  ranges_.for_each(
      [&](const VertexRanges::Range& range) {
        range.for_each_face([&](std::uint32_t f) {
          prefetch_stream(&faces_[f]);
          for (const std::uint32_t v : faces_[f].origin)
            if (range.has(v)) ++ends[v];
        });
      },
      stop);
  if (!goes_on(stop)) return false;
  std::size_t most = 0;
  std::uint32_t sum = 0;
  for (std::uint32_t& end : ends) {
    const std::uint32_t count = end;
    most = std::max<std::size_t>(most, count);
    end = sum;
    sum += count;
  }
  ranges_.for_each(
      [&](const VertexRanges::Range& range) {
        range.for_each_face([&](std::uint32_t f) {
          prefetch_stream(&faces_[f]);
          for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t v = faces_[f].origin[i];
            if (range.has(v)) leaving[ends[v]++] = 4 * f + i;
          }
        });
      },
      stop);
  if (!goes_on(stop)) return false;

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
    if (!goes_on(stop)) return found;
    Fan fan(most);
    std::size_t first = begin == 0 ? 0 : ends[begin - 1];
    for (std::size_t v = begin; v < end && found.single; first = ends[v++]) {
      const std::size_t count = ends[v] - first;
      const std::uint32_t* const at = leaving + first;
      leading[v] = count == 0 ? kInvalid : at[count - 1];
      for (std::size_t i = 0; i < kUsual; ++i) prefetch(&faces_[at[kAhead + i] / 4]);
      if (count == 0) continue;
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
  if (!fans.single || !goes_on(stop)) return false;
  return add_ghosts(fans.boundary);
}

bool EditFaces::copy(const HalfEdgeMesh& mesh) {
  face_count_ = mesh.face_count();
  apex_ = static_cast<std::uint32_t>(mesh.vertex_count());
  if (face_count_ > kMaxFaces) return false;
  faces_ = LargeArray<Face>(face_count_ + face_count_ / 16 + 64);
  const auto origins = mesh.origins(), twins = mesh.twins();
  ranges_ = VertexRanges(mesh.vertex_count(), face_count_, [&](std::size_t begin, std::size_t end) {
    VertexRanges::Extent extent;
    for (std::size_t f = begin; f < end; ++f) {
      Face& face = faces_[f];
      face.tags = 0;
      face.source = static_cast<std::uint32_t>(f);
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t t = twins[3 * f + i];
        face.origin[i] = origins[3 * f + i];
        face.twin[i] = t == kInvalid ? kInvalid : t + t / 3;
        extent.add(face.origin[i]);
      }
    }
    return extent;
  });
  std::vector<std::uint32_t> boundary;  // in the order of the vertices, each of which starts one at most
  for (const std::uint32_t h : mesh.leadings())
    if (h != kInvalid && twins[h] == kInvalid) boundary.push_back(h + h / 3);
  return add_ghosts(boundary);
}

// Puts a ghost, the triangle (target, origin, apex), beyond each boundary edge; these in the order of their
// origins, of which none comes twice.
bool EditFaces::add_ghosts(std::span<const std::uint32_t> boundary) {
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

Result<void> EditFaces::validate_connectivity(std::span<const std::uint32_t> leading) const {
  const auto broken = [](const char* rule, const char* element, std::size_t index) {
    return fail(ErrorCode::kUnsuitable, std::string("connectivity is broken: ") + rule + " (" + element +
                                            " " + std::to_string(index) + ")");
  };
  const std::size_t bound = half_edge_bound();
  if (face_count_ + ghosts_ > faces_.size()) return broken("faces have records", "face", faces_.size());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::vector<std::uint32_t> degree(leading.size(), 0);
  for (std::uint32_t h = 0; h < bound; ++h) {
    if (h % 4 == 3) continue;
    if (!alive(h)) {
      if (face(h).tags != 0) return broken("a face that is gone has no tags", "face", h / 4);
      continue;
    }
    const std::uint32_t p = origin(h);
    if (p >= leading.size()) return broken("an origin is a vertex", "half-edge", h);
    if (p == target(h)) return broken("a face repeats no vertex", "face", h / 4);
    if ((p == apex_) != (is_ghost(h) && h % 4 == 2))
      return broken("the apex is the last corner of each ghost, and of no other face", "half-edge", h);
    ++degree[p];
  }
  for (std::uint32_t h = 0; h < bound; ++h) {
    if (h % 4 == 3 || !alive(h)) continue;
    const std::uint32_t p = origin(h), q = target(h), t = twin(h);
    if (t >= bound || t % 4 == 3 || !alive(t)) return broken("a twin is a half-edge", "half-edge", h);
    if (t == h || twin(t) != h) return broken("twins are mutual", "half-edge", h);
    if (origin(t) != q) return broken("twins run in opposite directions", "half-edge", h);
    if (p != apex_ && q != apex_) {
      edges.emplace_back(p, q);
      if (is_ghost(h) && is_ghost(t)) return broken("an edge has a face", "half-edge", h);
    }
  }
  std::ranges::sort(edges);
  if (const auto twice = std::ranges::adjacent_find(edges); twice != edges.end())
    return broken("one edge joins two vertices", "vertex", twice->first);
  for (std::uint32_t v = 0; v < leading.size(); ++v) {
    const std::uint32_t start = leading[v];
    if (v == apex_) continue;
    if ((start & kVertexGone) != 0) {
      if (degree[v] != 0) return broken("a vertex that is gone has no faces", "vertex", v);
      continue;
    }
    if (start >= bound || start % 4 == 3 || !alive(start) || origin(start) != v)
      return broken("a leading half-edge leaves its vertex", "vertex", v);
    std::uint32_t met = 0, h = start;
    do {
      ++met;
      h = around_vertex(h);
    } while (h != start && met <= degree[v]);
    if (met != degree[v]) return broken("a vertex has one fan", "vertex", v);
  }
  return {};
}

}  // namespace vkmesh::detail
