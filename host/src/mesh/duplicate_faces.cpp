#include "mesh/duplicate_faces.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <tuple>
#include <utility>

#include <tbb/parallel_sort.h>

#include "mesh/edge_records.h"

namespace vkmesh::detail {
namespace {

/// A face as its smallest point, then round in the direction of that point's smaller neighbour.
class Canonical {
 public:
  explicit Canonical(std::span<const std::uint32_t> face) : face_(face) {
    start_ = static_cast<std::size_t>(std::min_element(face.begin(), face.end()) - face.begin());
    const std::size_t n = face.size();
    reversed_ = face[(start_ + n - 1) % n] < face[(start_ + 1) % n];
  }
  [[nodiscard]] std::uint32_t operator[](std::size_t i) const {
    const std::size_t n = face_.size();
    return face_[reversed_ ? (start_ + n - i) % n : (start_ + i) % n];
  }
  [[nodiscard]] bool reversed() const { return reversed_; }

  friend bool operator==(const Canonical& a, const Canonical& b) {
    if (a.face_.size() != b.face_.size()) return false;
    for (std::size_t i = 0; i < a.face_.size(); ++i)
      if (a[i] != b[i]) return false;
    return true;
  }

 private:
  std::span<const std::uint32_t> face_;
  std::size_t start_;
  bool reversed_;
};

}  // namespace

std::vector<DuplicateFace> duplicate_faces(const IndexedFaceSet& mesh) {
  // Three points of the canonical form bring those together that may be the same.
  struct Key {
    std::uint32_t a, b, c, face;
    auto points() const { return std::tie(a, b, c); }
  };
  std::vector<Key> keys;
  keys.reserve(mesh.face_count());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (is_degenerate(mesh.face(f))) continue;
    const Canonical form(mesh.face(f));
    keys.push_back({form[0], form[1], form[2], f});
  }
  tbb::parallel_sort(keys.begin(), keys.end(), [](const Key& x, const Key& y) {
    return std::tie(x.a, x.b, x.c, x.face) < std::tie(y.a, y.b, y.c, y.face);
  });

  std::vector<DuplicateFace> result;
  std::vector<std::uint32_t> left;
  for (std::size_t i = 0; i < keys.size();) {
    std::size_t j = i + 1;
    while (j < keys.size() && keys[j].points() == keys[i].points()) ++j;
    left.clear();
    if (j - i > 1)
      for (std::size_t k = i; k < j; ++k) left.push_back(keys[k].face);
    // Polygons that agree in three points may differ further on.
    while (left.size() > 1) {
      const Canonical first(mesh.face(left[0]));
      const std::size_t before = result.size();
      result.push_back({left[0], left[0], false});
      std::vector<std::uint32_t> others;
      for (std::size_t k = 1; k < left.size(); ++k) {
        const Canonical other(mesh.face(left[k]));
        if (other == first)
          result.push_back({left[k], left[0], other.reversed() != first.reversed()});
        else
          others.push_back(left[k]);
      }
      if (result.size() == before + 1) result.pop_back();
      left = std::move(others);
    }
    i = j;
  }
  return result;
}

}  // namespace vkmesh::detail
