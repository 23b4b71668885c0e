#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/mesh/triangulate.h>

#include "mesh/ear_clipper.h"

namespace vkmesh {
namespace {

/// Two points as one number, whichever comes first.
std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

/// A set of edges that may hold some that were not put into it: one bit for each, of as many as hash there.
class EdgeFilter {
 public:
  explicit EdgeFilter(std::size_t edges) {
    while (shift_ > 32 && (std::uint64_t{1} << (64 - shift_)) < 16 * edges) --shift_;
    bits_.resize((std::size_t{1} << (64 - shift_)) / 64 + 1);
  }
  [[nodiscard]] bool has(std::uint64_t key) const {
    return (bits_[place(key) / 64] >> place(key) % 64 & 1) != 0;
  }
  void put(std::uint64_t key) { bits_[place(key) / 64] |= std::uint64_t{1} << place(key) % 64; }

 private:
  [[nodiscard]] std::uint64_t place(std::uint64_t key) const { return key * 0x9e3779b97f4a7c15u >> shift_; }
  unsigned shift_ = 54;
  std::vector<std::uint64_t> bits_;
};

class Triangulation {
 public:
  explicit Triangulation(const IndexedFaceSet& mesh) : mesh_(mesh) {}

  Triangulated cut() {
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
      first_.push_back(result_.source_face.size());
      const std::size_t corners = mesh_.face(f).size();
      if (corners < 3) continue;
      for (std::size_t t = 0; t < corners - 2; ++t) {
        result_.source_face.push_back(static_cast<std::uint32_t>(f));
        places_.insert(places_.end(), {0, 1, 2});
      }
      if (corners > 3) cut_face(f, [](std::uint32_t, std::uint32_t) { return false; });
    }
    first_.push_back(result_.source_face.size());
    cut_others(faces_with_shared_diagonals());

    IndexedFaceSet& mesh = result_.mesh;
    mesh.points = mesh_.points;
    mesh.point_channels = mesh_.point_channels;
    std::vector<std::uint32_t> source_corner;
    mesh.corners.reserve(places_.size());
    for (std::size_t t = 0; t < result_.source_face.size(); ++t)
      for (std::size_t k = 3 * t; k < 3 * t + 3; ++k) {
        const std::uint32_t corner = mesh_.face_offsets[result_.source_face[t]] + places_[k];
        mesh.corners.push_back(mesh_.corners[corner]);
        if (!mesh_.corner_channels.empty()) source_corner.push_back(corner);
      }
    mesh.corner_channels = gather(mesh_.corner_channels, source_corner);
    mesh.face_channels = gather(mesh_.face_channels, result_.source_face);
    return std::move(result_);
  }

 private:
  template <class Taken>
  void cut_face(std::size_t f, Taken&& taken) {
    std::size_t at = 3 * first_[f];
    clipper_.clip(
        mesh_.points, mesh_.face(f),
        [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
          for (const std::uint32_t place : {i, j, k}) places_[at++] = place;
        },
        taken);
  }

  /// Calls see(key) for each diagonal of a face, once.
  template <class See>
  void each_diagonal(std::size_t f, See&& see) const {
    const auto corners = mesh_.face(f);
    for (std::size_t t = first_[f]; t < first_[f + 1]; ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = places_[3 * t + k], j = places_[3 * t + (k + 1) % 3];
        // Each lies in two triangles, which run along it in opposite directions.
        if (i < j && j - i > 1 && j - i < corners.size() - 1) see(edge_key(corners[i], corners[j]));
      }
  }

  template <class See>
  void each_edge(std::size_t f, See&& see) const {
    const auto corners = mesh_.face(f);
    for (std::size_t k = 0; k < corners.size(); ++k)
      see(edge_key(corners[k], corners[k + 1 == corners.size() ? 0 : k + 1]));
  }

  /// Faces with a diagonal that is an edge of a face or a diagonal of another one.
  std::vector<std::uint32_t> faces_with_shared_diagonals() const {
    const std::size_t faces = mesh_.face_count();
    EdgeFilter filter(result_.source_face.size() - std::min(result_.source_face.size(), faces) + 1);
    std::vector<std::uint64_t> edges, diagonals;  // Suspects: all that are shared, and few others.
    for (std::size_t f = 0; f < faces; ++f)
      each_diagonal(f, [&](std::uint64_t key) {
        if (filter.has(key)) diagonals.push_back(key);
        filter.put(key);
      });
    for (std::size_t f = 0; f < faces; ++f)
      each_edge(f, [&](std::uint64_t key) {
        if (filter.has(key)) edges.push_back(key);
      });
    std::sort(edges.begin(), edges.end());
    std::sort(diagonals.begin(), diagonals.end());
    diagonals.erase(std::unique(diagonals.begin(), diagonals.end()), diagonals.end());
    std::vector<std::uint32_t> uses(diagonals.size());
    const auto place_of = [&](std::uint64_t key) {
      const auto found = std::lower_bound(diagonals.begin(), diagonals.end(), key);
      return found != diagonals.end() && *found == key ? static_cast<std::size_t>(found - diagonals.begin())
                                                       : diagonals.size();
    };
    for (std::size_t f = 0; f < faces; ++f)
      each_diagonal(f, [&](std::uint64_t key) {
        if (const std::size_t at = place_of(key); at < uses.size()) ++uses[at];
      });
    std::vector<std::uint32_t> found;
    for (std::size_t f = 0; f < faces; ++f) {
      bool shared = false;
      each_diagonal(f, [&](std::uint64_t key) {
        const std::size_t at = place_of(key);
        shared = shared || (at < uses.size() && uses[at] > 1) ||
                 std::binary_search(edges.begin(), edges.end(), key);
      });
      if (shared) found.push_back(static_cast<std::uint32_t>(f));
    }
    return found;
  }

  /// Cuts these faces again, along diagonals that are no edges of the mesh where there are any.
  void cut_others(const std::vector<std::uint32_t>& faces) {
    if (faces.empty()) return;
    std::vector<bool> near(mesh_.points.size());
    for (const std::uint32_t f : faces)
      for (const std::uint32_t point : mesh_.face(f)) near[point] = true;
    std::unordered_map<std::uint64_t, std::uint32_t> uses;
    const auto is_near = [&](std::uint64_t key) { return near[key >> 32] && near[key & 0xffffffffu]; };
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
      const auto see = [&](std::uint64_t key) {
        if (is_near(key)) ++uses[key];
      };
      each_edge(f, see);
      each_diagonal(f, see);
    }
    for (const std::uint32_t f : faces) {
      each_diagonal(f, [&](std::uint64_t key) { --uses[key]; });
      cut_face(f, [&](std::uint32_t a, std::uint32_t b) {
        const auto found = uses.find(edge_key(a, b));
        return found != uses.end() && found->second > 0;
      });
      each_diagonal(f, [&](std::uint64_t key) { ++uses[key]; });
    }
  }

  const IndexedFaceSet& mesh_;
  Triangulated result_;
  std::vector<std::size_t> first_;     ///< Triangle of each face, and their number.
  std::vector<std::uint32_t> places_;  ///< Where the corners of the triangles stand in their faces.
  detail::EarClipper clipper_;
};

Triangulated cut(const IndexedFaceSet& mesh) {
  if (!mesh.is_triangles()) return Triangulation(mesh).cut();
  Triangulated result;
  result.mesh = mesh;
  result.source_face.resize(mesh.face_count());
  std::iota(result.source_face.begin(), result.source_face.end(), 0u);
  return result;
}

}  // namespace

Result<Triangulated> triangulate(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<Triangulated> { return cut(mesh); });
}

}  // namespace vkmesh
