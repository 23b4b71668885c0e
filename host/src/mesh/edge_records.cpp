#include "mesh/edge_records.h"

#include <array>
#include <limits>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "base/stop.h"

namespace vkmesh::detail {

Result<void> check_face_set(std::size_t point_count, std::span<const std::uint32_t> corners,
                            std::span<const std::uint32_t> face_offsets) {
  if (corners.size() >= kInvalid || point_count >= kInvalid)
    return fail(ErrorCode::kUnsuitable, "the mesh has more than 2^32 - 2 corners or points");
  if (face_offsets.empty() && corners.size() % 3 != 0)
    return fail(ErrorCode::kUsage, "a triangle list must have a multiple of three corners, not " +
                                       std::to_string(corners.size()));
  if (!face_offsets.empty()) {
    if (face_offsets.front() != 0 || face_offsets.back() != corners.size() ||
        !std::is_sorted(face_offsets.begin(), face_offsets.end()))
      return fail(ErrorCode::kUsage, "face offsets must ascend from 0 to the number of corners");
  }
  std::uint32_t largest = 0;
  for (const std::uint32_t c : corners) largest = std::max(largest, c);
  if (!corners.empty() && largest >= point_count)
    return fail(ErrorCode::kUsage, "a face names point " + std::to_string(largest) + ", but there are " +
                                       std::to_string(point_count) + " points");
  return {};
}

bool is_degenerate(std::span<const std::uint32_t> face) {
  if (face.size() < 3) return true;
  if (face.size() == 3) return face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
  std::vector<std::uint32_t> sorted(face.begin(), face.end());
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
}

FaceOfCorner::FaceOfCorner(const IndexedFaceSet& mesh) {
  if (mesh.is_triangles()) return;
  faces_.resize(mesh.corners.size());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    std::fill(faces_.begin() + mesh.face_offsets[f], faces_.begin() + mesh.face_offsets[f + 1], f);
}

// Sorts the records of one point. Most points have eight or fewer (six on a regular mesh), and a branch on
// the data costs more than the rest, so these pass through Batcher's odd-even merge network.
void EdgeRecords::sort_records(std::span<std::uint64_t> records) {
  const auto begin = records.begin(), end = records.end();
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

// Two blocks of faces count and place at once, the second behind the first within each point; more would cost
// more memory than they save time.
EdgeRecords distribute_edges(std::size_t point_count, std::span<const std::uint32_t> corners,
                             std::span<const std::uint32_t> face_offsets, std::size_t face_count,
                             Stop* stop) {
  constexpr std::size_t kBlocks = 2, kBetween = std::size_t{1} << 15;  // faces from one question to the next
  EdgeRecords result{std::vector<std::uint64_t>(corners.size()), std::vector<std::uint32_t>(point_count)};
  std::array<std::vector<std::uint32_t>, kBlocks> slots;
  const auto for_each_block = [&](auto&& body) {
    parallel_ranges(kBlocks, 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t b = first; b < last; ++b) {
        const std::size_t end = face_count * (b + 1) / kBlocks;
        auto visit = body(b);
        for (std::size_t f = face_count * b / kBlocks; f < end && goes_on(stop); f += kBetween)
          for_each_edge(corners, face_offsets, f, std::min(f + kBetween, end), visit);
      }
    });
  };
  for_each_block([&](std::size_t b) {
    slots[b].assign(point_count, 0);
    return [slot = slots[b].data()](std::uint32_t, std::uint32_t from, std::uint32_t to) {
      ++slot[std::min(from, to)];
    };
  });
  if (!goes_on(stop)) return result;
  std::uint32_t placed = 0;
  for (std::size_t a = 0; a < point_count; ++a) {
    for (std::vector<std::uint32_t>& slot : slots) placed += std::exchange(slot[a], placed);
    result.end[a] = placed;
  }
  for_each_block([&](std::size_t b) {
    return [slot = slots[b].data(), records = result.records.data()](std::uint32_t h, std::uint32_t from,
                                                                     std::uint32_t to) {
      const std::uint32_t other = from == to ? EdgeRecords::kLoop : std::max(from, to);
      records[slot[std::min(from, to)]++] = std::uint64_t{other} << 32 | h;
    };
  });
  return result;
}

}  // namespace vkmesh::detail
