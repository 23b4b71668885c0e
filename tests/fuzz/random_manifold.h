// Triangle meshes that are manifolds whatever bytes they are made of, for the targets that fuzz algorithms
// which take nothing else.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/mesh/indexed_face_set.h>
#include <vkmesh/repair/consolidate.h>

namespace vkmesh::fuzz {

/// Bytes one after another; what is missing at the end is zero.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  [[nodiscard]] bool empty() const { return at_ >= bytes_.size(); }
  std::uint8_t next() { return empty() ? std::uint8_t{0} : bytes_[at_++]; }
  /// A number below `count`, which is at most 2^16.
  std::uint32_t below(std::size_t count) {
    const std::uint32_t low = next(), high = count > 256 ? next() : 0u;
    return static_cast<std::uint32_t>((low + 256 * high) % count);
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

/// An oriented manifold of triangles that is built up from simple shapes.
class RandomManifold {
 public:
  using Face = std::array<std::uint32_t, 3>;
  static constexpr std::size_t kMostFaces = 240;

  /// One to three shapes, up to 255 changes to them, then places; `bytes` is left where that ends.
  explicit RandomManifold(Bytes& bytes) {
    for (std::uint32_t shapes = 1 + bytes.below(3); shapes > 0; --shapes) add_shape(bytes);
    for (std::uint32_t changes = bytes.next(); changes > 0 && !bytes.empty(); --changes) change(bytes);
    drop_isolated(bytes.next() % 4 != 0);
    std::mt19937 random(bytes.next());
    shuffle(random);
    place(bytes, random);
  }

  /// Places are doubles.
  [[nodiscard]] const std::vector<std::array<double, 3>>& points() const { return points_; }
  [[nodiscard]] std::vector<std::uint32_t> corners() const {
    std::vector<std::uint32_t> corners;
    for (const Face& face : faces_) corners.insert(corners.end(), face.begin(), face.end());
    return corners;
  }

 private:
  std::uint32_t add_point(double x, double y, double z) {
    points_.push_back({x, y, z});
    return static_cast<std::uint32_t>(points_.size() - 1);
  }

  void add_shape(Bytes& bytes) {
    const std::uint32_t kind = bytes.below(6), m = bytes.next() % 6, n = bytes.next() % 6;
    const auto first = static_cast<std::uint32_t>(points_.size());
    const double away = 3.0 * static_cast<double>(faces_.size() > 0);
    const auto circle = [](std::uint32_t i, std::uint32_t of) {
      // Among corners of a square, for whole numbers that are often in one line.
      constexpr std::array<std::array<double, 2>, 8> kPlaces = {
          {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
      return kPlaces[i * 8 / of];
    };
    const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
      faces_.push_back({a, b, c});
      faces_.push_back({a, c, d});
    };
    switch (kind) {
      case 0:  // a tetrahedron
        for (const auto& p : {Face{0, 0, 0}, Face{1, 0, 0}, Face{0, 1, 0}, Face{0, 0, 1}})
          add_point(away + p[0], p[1], p[2]);
        for (const auto& f : {Face{0, 2, 1}, Face{0, 1, 3}, Face{1, 2, 3}, Face{2, 0, 3}})
          faces_.push_back({first + f[0], first + f[1], first + f[2]});
        break;
      case 1:  // a flat grid
        for (std::uint32_t j = 0; j <= n + 1; ++j)
          for (std::uint32_t i = 0; i <= m + 1; ++i) add_point(away + i, j, 0);
        for (std::uint32_t j = 0; j <= n; ++j)
          for (std::uint32_t i = 0; i <= m; ++i) {
            const std::uint32_t p = first + i + j * (m + 2);
            quad(p, p + 1, p + m + 3, p + m + 2);
          }
        break;
      case 2:    // a torus
      case 3: {  // a tube
        const bool closed = kind == 2;
        const std::uint32_t rings = m + 3, sides = n + 3;
        for (std::uint32_t j = 0; j < rings; ++j)
          for (std::uint32_t i = 0; i < sides; ++i) {
            const auto inner = circle(i, sides), outer = circle(j, rings);
            if (closed)
              add_point(away + outer[0] * (3 + inner[0]), outer[1] * (3 + inner[0]), inner[1]);
            else
              add_point(away + inner[0], inner[1], j);
          }
        for (std::uint32_t j = 0; j + (closed ? 0 : 1) < rings; ++j)
          for (std::uint32_t i = 0; i < sides; ++i) {
            const std::uint32_t i1 = (i + 1) % sides, j1 = (j + 1) % rings;
            quad(first + i + j * sides, first + i1 + j * sides, first + i1 + j1 * sides,
                 first + i + j1 * sides);
          }
        break;
      }
      default: {  // one or two pyramids on the same polygon, of up to some dozen sides
        const bool two = kind == 4;
        const std::uint32_t sides = 3 + m + 6 * n;
        const std::uint32_t top = add_point(away, 0, 1), bottom = two ? add_point(away, 0, -1) : 0;
        for (std::uint32_t i = 0; i < sides; ++i) {
          const auto at = circle(i, sides);
          add_point(away + at[0], at[1], 0.125 * (i % 2));
        }
        const std::uint32_t base = two ? bottom + 1 : top + 1;
        for (std::uint32_t i = 0; i < sides; ++i) {
          const std::uint32_t a = base + i, b = base + (i + 1) % sides;
          faces_.push_back({a, b, top});
          if (two) faces_.push_back({b, a, bottom});
        }
        break;
      }
    }
  }

  void change(Bytes& bytes) {
    const std::uint32_t kind = bytes.next() % 8;
    if (faces_.empty()) return;
    const std::uint32_t f = bytes.below(faces_.size()), i = kind / 2 % 3;
    const bool room = faces_.size() + 6 <= kMostFaces;
    switch (kind) {
      case 0:
        if (room) split_face(f);
        break;
      case 1:
      case 2:
        if (room) split_edge(f, i);
        break;
      case 3:
      case 4:
      case 5:
        flip(f, i);
        break;
      case 6:
        remove_face(f);
        break;
      default: {
        const std::uint32_t g = bytes.below(faces_.size());
        if (room && g != f) join_by_tube(f, g);
      }
    }
  }

  [[nodiscard]] std::array<double, 3> middle(std::uint32_t a, std::uint32_t b) const {
    std::array<double, 3> m;
    for (std::size_t k = 0; k < 3; ++k) m[k] = 0.5 * (points_[a][k] + points_[b][k]);
    return m;
  }

  void split_face(std::uint32_t f) {
    const auto [a, b, c] = faces_[f];
    std::array<double, 3> m;
    for (std::size_t k = 0; k < 3; ++k) m[k] = (points_[a][k] + points_[b][k] + points_[c][k]) / 3;
    const std::uint32_t v = add_point(m[0], m[1], m[2]);
    faces_[f] = {a, b, v};
    faces_.push_back({b, c, v});
    faces_.push_back({c, a, v});
  }

  /// The face with the edge from a to b and the corner where that starts; the number of faces if there is
  /// none.
  [[nodiscard]] std::pair<std::size_t, std::size_t> find(std::uint32_t a, std::uint32_t b) const {
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (std::size_t i = 0; i < 3; ++i)
        if (faces_[f][i] == a && faces_[f][(i + 1) % 3] == b) return {f, i};
    return {faces_.size(), 0};
  }

  void split_edge(std::uint32_t f, std::uint32_t i) {
    const std::uint32_t a = faces_[f][i], b = faces_[f][(i + 1) % 3], c = faces_[f][(i + 2) % 3];
    const auto [g, j] = find(b, a);
    const std::array<double, 3> m = middle(a, b);
    const std::uint32_t v = add_point(m[0], m[1], m[2]);
    const std::size_t before = faces_.size();
    faces_[f] = {a, v, c};
    faces_.push_back({v, b, c});
    if (g == before) return;
    const std::uint32_t d = faces_[g][(j + 2) % 3];
    faces_[g] = {b, v, d};
    faces_.push_back({v, a, d});
  }

  void flip(std::uint32_t f, std::uint32_t i) {
    const std::uint32_t a = faces_[f][i], b = faces_[f][(i + 1) % 3], c = faces_[f][(i + 2) % 3];
    const auto [g, j] = find(b, a);
    if (g == faces_.size()) return;
    const std::uint32_t d = faces_[g][(j + 2) % 3];
    if (c == d || find(c, d).first < faces_.size() || find(d, c).first < faces_.size()) return;
    faces_[f] = {a, d, c};
    faces_[g] = {d, b, c};
  }

  /// Takes the change back unless a manifold is left.
  template <class Change>
  void attempt(Change&& apply) {
    const std::vector<Face> before = faces_;
    apply();
    IndexedFaceSet mesh;
    mesh.points.resize(points_.size());
    mesh.corners = corners();
    const auto report = diagnose(mesh);
    if (!report || !report->manifold() || faces_.empty()) faces_ = before;
  }

  void remove_face(std::uint32_t f) {
    attempt([&] { faces_.erase(faces_.begin() + f); });
  }

  /// A handle, or a bridge to another component.
  void join_by_tube(std::uint32_t f, std::uint32_t g) {
    attempt([&] {
      const Face a = faces_[f], b = {faces_[g][0], faces_[g][2], faces_[g][1]};
      faces_.erase(faces_.begin() + std::max(f, g));
      faces_.erase(faces_.begin() + std::min(f, g));
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        faces_.push_back({a[i], a[j], b[i]});
        faces_.push_back({a[j], b[j], b[i]});
      }
    });
  }

  void drop_isolated(bool all) {
    std::vector<std::uint32_t> number(points_.size(), kInvalid);
    for (const Face& face : faces_)
      for (const std::uint32_t v : face) number[v] = 0;
    std::vector<std::array<double, 3>> kept;
    for (std::size_t v = 0; v < points_.size(); ++v) {
      if (all && number[v] == kInvalid) continue;
      number[v] = static_cast<std::uint32_t>(kept.size());
      kept.push_back(points_[v]);
    }
    for (Face& face : faces_)
      for (std::uint32_t& v : face) v = number[v];
    points_ = std::move(kept);
  }

  template <class T>
  static void mix(std::vector<T>& all, std::mt19937& random) {
    for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[random() % i]);
  }

  void shuffle(std::mt19937& random) {
    std::vector<std::uint32_t> order(points_.size());
    std::iota(order.begin(), order.end(), 0u);
    mix(order, random);
    mix(faces_, random);
    auto places = points_;
    for (std::size_t v = 0; v < order.size(); ++v) places[order[v]] = points_[v];
    points_ = std::move(places);
    for (Face& face : faces_) {
      std::rotate(face.begin(), face.begin() + random() % 3, face.end());
      for (std::uint32_t& v : face) v = order[v];
    }
  }

  void place(Bytes& bytes, std::mt19937& random) {
    const std::uint32_t kind = bytes.next() % 8;
    for (auto& p : points_)
      for (std::size_t k = 0; k < 3; ++k) {
        const double noise = static_cast<double>(random() % 4096) / 4096 - 0.5;
        if (kind == 1 || kind == 2) p[k] += kind == 1 ? 0.25 * noise : 2 * noise;
        if (kind == 3) p[k] = static_cast<double>(random() % 4);  // many coincide
        if (kind == 4) p[k] = k == 2 ? 0 : p[k] + 0.5 * noise;    // flat
        if (kind == 5) p[k] = k == 0 ? p[k] : 0;                  // in a line
        if (kind == 6) p[k] = 1;                                  // in a point
      }
    // Some go elsewhere.
    for (std::uint32_t moved = bytes.next() % 16; moved > 0 && !points_.empty(); --moved) {
      auto& p = points_[bytes.below(points_.size())];
      const std::uint32_t how = bytes.next();
      if (how % 4 == 0) p = points_[bytes.below(points_.size())];
      if (how % 4 == 1) p[how / 4 % 3] *= 1e6;
      if (how % 4 == 2) p[how / 4 % 3] = 1e-30;
      if (how % 4 == 3)
        for (double& x : p) x = static_cast<double>(bytes.next()) / 64 - 2;
    }
    constexpr std::array<double, 8> kScales = {1, 1, 1e-3, 1e6, 1e-20, 1e18, 1e-42, 1e37};
    constexpr std::array<double, 4> kOffsets = {0, 0, 1e3, 1e7};
    const double scale = kScales[bytes.next() % 8], offset = kOffsets[bytes.next() % 4];
    for (auto& p : points_)
      for (double& x : p) x = scale * (x + offset);
  }

  std::vector<std::array<double, 3>> points_;
  std::vector<Face> faces_;
};

}  // namespace vkmesh::fuzz
