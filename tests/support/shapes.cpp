#include "support/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include <catch2/catch.hpp>

#include <vkmesh/repair/consolidate.h>

namespace vkmesh::test {
namespace {

constexpr float kTwoPi = 2.0f * std::numbers::pi_v<float>;

void add_triangle(IndexedFaceSet& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh.corners.insert(mesh.corners.end(), {a, b, c});
}

void add_quad(IndexedFaceSet& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

}  // namespace

IndexedFaceSet tetrahedron() {
  IndexedFaceSet mesh;
  mesh.points = {{0.0f, 0.0f, 1.73205f},
                 {0.0f, 1.63299f, -0.57735f},
                 {-1.41421f, -0.816497f, -0.57735f},
                 {1.41421f, -0.816497f, -0.57735f}};
  mesh.corners = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};
  return mesh;
}

IndexedFaceSet quad_cube() {
  IndexedFaceSet mesh;
  for (int i = 0; i < 8; ++i)
    mesh.points.emplace_back(static_cast<float>(i & 1), static_cast<float>((i >> 1) & 1),
                             static_cast<float>(i >> 2));
  mesh.corners = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
  mesh.face_offsets = {0, 4, 8, 12, 16, 20, 24};
  return mesh;
}

IndexedFaceSet cube() {
  const IndexedFaceSet quads = quad_cube();
  IndexedFaceSet mesh;
  mesh.points = quads.points;
  for (std::size_t f = 0; f < quads.face_count(); ++f) {
    const auto c = quads.face(f);
    add_quad(mesh, c[0], c[1], c[2], c[3]);
  }
  return mesh;
}

IndexedFaceSet fine_cube(int n) {
  IndexedFaceSet set;
  std::map<std::array<int, 3>, std::uint32_t> numbers;
  const auto point = [&](std::array<int, 3> at) {
    const auto [found, added] = numbers.try_emplace(at, static_cast<std::uint32_t>(set.points.size()));
    if (added)
      set.points.push_back(
          Vec3(static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2])) /
          static_cast<float>(n));
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool far : {false, true})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int di, int dj) {
            std::array<int, 3> p{};
            p[axis] = far ? n : 0;
            p[(axis + (far ? 1 : 2)) % 3] = i + di;
            p[(axis + (far ? 2 : 1)) % 3] = j + dj;
            return point(p);
          };
          const std::uint32_t a = at(0, 0), b = at(1, 0), c = at(1, 1), d = at(0, 1);
          set.corners.insert(set.corners.end(), {a, b, c, a, c, d});
        }
  return set;
}

IndexedFaceSet icosphere(unsigned level, float radius) {
  const double t = (1.0 + std::sqrt(5.0)) / 2.0;
  std::vector<DVec3> points = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                               {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  std::vector<std::array<std::uint32_t, 3>> faces = {
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (unsigned l = 0; l < level; ++l) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
    const auto split = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, inserted] =
          middle.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(points.size()));
      if (inserted) points.push_back((points[a] + points[b]) * 0.5);
      return it->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const std::uint32_t ab = split(a, b), bc = split(b, c), ca = split(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    faces = std::move(finer);
    for (DVec3& p : points) p = p / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
  }
  IndexedFaceSet mesh;
  for (const DVec3& p : points)
    mesh.points.emplace_back(p *
                             (static_cast<double>(radius) / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z)));
  for (const auto& [a, b, c] : faces) add_triangle(mesh, a, b, c);
  return mesh;
}

IndexedFaceSet torus(std::uint32_t rings, std::uint32_t sides, float major, float minor) {
  IndexedFaceSet mesh;
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < sides; ++j) {
      const float u = kTwoPi * static_cast<float>(i) / static_cast<float>(rings);
      const float v = kTwoPi * static_cast<float>(j) / static_cast<float>(sides);
      const float r = major + minor * std::cos(v);
      mesh.points.emplace_back(r * std::cos(u), r * std::sin(u), minor * std::sin(v));
    }
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < sides; ++j) {
      const std::uint32_t i1 = (i + 1) % rings, j1 = (j + 1) % sides;
      add_quad(mesh, i * sides + j, i1 * sides + j, i1 * sides + j1, i * sides + j1);
    }
  return mesh;
}

IndexedFaceSet grid(std::uint32_t nx, std::uint32_t ny) {
  IndexedFaceSet mesh;
  for (std::uint32_t y = 0; y <= ny; ++y)
    for (std::uint32_t x = 0; x <= nx; ++x)
      mesh.points.emplace_back(static_cast<float>(x), static_cast<float>(y), 0.0f);
  for (std::uint32_t y = 0; y < ny; ++y)
    for (std::uint32_t x = 0; x < nx; ++x) {
      const std::uint32_t p = y * (nx + 1) + x;
      add_quad(mesh, p, p + 1, p + nx + 2, p + nx + 1);
    }
  return mesh;
}

IndexedFaceSet mobius(std::uint32_t n) {
  IndexedFaceSet mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (int side = -1; side <= 1; side += 2) {
      const float u = kTwoPi * static_cast<float>(i) / static_cast<float>(n);
      const float w = 0.3f * static_cast<float>(side);
      const float r = 1.0f + w * std::cos(u / 2);
      mesh.points.emplace_back(r * std::cos(u), r * std::sin(u), w * std::sin(u / 2));
    }
  for (std::uint32_t i = 0; i + 1 < n; ++i) add_quad(mesh, 2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1);
  add_quad(mesh, 2 * n - 2, 1, 0, 2 * n - 1);
  return mesh;
}

IndexedFaceSet cylinder(std::uint32_t rings, std::uint32_t sides) {
  IndexedFaceSet mesh;
  for (std::uint32_t i = 0; i <= rings; ++i)
    for (std::uint32_t j = 0; j < sides; ++j) {
      const float v = kTwoPi * static_cast<float>(j) / static_cast<float>(sides);
      mesh.points.emplace_back(std::cos(v), std::sin(v), static_cast<float>(i));
    }
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < sides; ++j) {
      const std::uint32_t j1 = (j + 1) % sides;
      add_quad(mesh, i * sides + j, i * sides + j1, (i + 1) * sides + j1, (i + 1) * sides + j);
    }
  return mesh;
}

IndexedFaceSet klein_bottle(std::uint32_t rings, std::uint32_t sides) {
  IndexedFaceSet mesh;
  const IndexedFaceSet ordinary = torus(rings, sides);
  mesh.points = ordinary.points;
  const auto point = [&](std::uint32_t ring, std::uint32_t side) {
    side %= sides;
    return ring == rings ? (sides - side) % sides : ring * sides + side;
  };
  for (std::uint32_t r = 0; r < rings; ++r)
    for (std::uint32_t s = 0; s < sides; ++s)
      add_quad(mesh, point(r, s), point(r + 1, s), point(r + 1, s + 1), point(r, s + 1));
  return mesh;
}

IndexedFaceSet both(const IndexedFaceSet& a, const IndexedFaceSet& b, Vec3 offset) {
  IndexedFaceSet mesh = a;
  for (const Vec3& p : b.points) mesh.points.push_back(p + offset);
  for (const std::uint32_t c : b.corners)
    mesh.corners.push_back(c + static_cast<std::uint32_t>(a.points.size()));
  return mesh;
}

IndexedFaceSet double_torus() {
  const IndexedFaceSet one = torus(8, 6);
  IndexedFaceSet mesh = both(one, one, Vec3(4.0f, 0.0f, 0.0f));
  const std::size_t second = one.corners.size();
  // Against each other, so that the faces around the holes agree.
  const std::uint32_t hole[3] = {mesh.corners[0], mesh.corners[1], mesh.corners[2]};
  const std::uint32_t other[3] = {mesh.corners[second], mesh.corners[second + 1], mesh.corners[second + 2]};
  mesh.corners.erase(mesh.corners.begin() + static_cast<std::ptrdiff_t>(second),
                     mesh.corners.begin() + static_cast<std::ptrdiff_t>(second) + 3);
  mesh.corners.erase(mesh.corners.begin(), mesh.corners.begin() + 3);
  for (std::uint32_t& c : mesh.corners)
    for (unsigned i = 0; i < 3; ++i)
      if (c == other[i]) c = hole[(3 - i) % 3];
  // The points of the second hole are not used any more: the last three take their places.
  std::vector<std::uint32_t> free(other, other + 3);
  std::sort(free.rbegin(), free.rend());
  for (const std::uint32_t gone : free) {
    const auto last = static_cast<std::uint32_t>(mesh.points.size() - 1);
    mesh.points[gone] = mesh.points[last];
    mesh.points.pop_back();
    for (std::uint32_t& c : mesh.corners)
      if (c == last) c = gone;
  }
  return mesh;
}

IndexedFaceSet tori_sharing_a_point() {
  const IndexedFaceSet one = torus(8, 6);
  IndexedFaceSet mesh = both(one, one, Vec3(10.0f, 0.0f, 0.0f));
  const auto shared = static_cast<std::uint32_t>(one.points.size());
  for (std::uint32_t& c : mesh.corners)
    if (c == shared)
      c = 0;
    else if (c > shared)
      --c;
  mesh.points.erase(mesh.points.begin() + shared);
  return mesh;
}

IndexedFaceSet bow_tie() {
  IndexedFaceSet mesh = tetrahedron();
  const Vec3 apex = mesh.points[0];
  for (int i = 1; i < 4; ++i) {
    const Vec3 p = mesh.points[static_cast<std::size_t>(i)];
    mesh.points.emplace_back(p.x, p.y, apex.z + (apex.z - p.z));
  }
  mesh.corners.insert(mesh.corners.end(), {0, 5, 4, 0, 6, 5, 0, 4, 6, 4, 5, 6});
  return mesh;
}

IndexedFaceSet fin() {
  IndexedFaceSet mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0.5f, 1, 0}, {0.5f, -1, 0}, {0.5f, 0, 1}};
  mesh.corners = {0, 1, 2, 1, 0, 3, 0, 1, 4};
  return mesh;
}

std::map<std::string, IndexedFaceSet> degenerate_shapes() {
  std::map<std::string, IndexedFaceSet> shapes;
  for (const auto& [name, shape] :
       {std::pair{"sphere", icosphere(2)}, std::pair{"grid", grid(6, 5)}, std::pair{"torus", torus(12, 8)}}) {
    IndexedFaceSet set = shape;
    set.points.emplace_back(0.3f, 0.2f, 0.1f);
    shapes[name + std::string(", points that coincide")] = set;
    IndexedFaceSet& coincide = shapes[name + std::string(", points that coincide")];
    for (std::size_t v = 0; v + 1 < set.points.size(); v += 5) coincide.points[v] = coincide.points[v + 1];
    IndexedFaceSet& slivers = shapes[name + std::string(", three points in a line")];
    slivers = set;
    for (std::size_t f = 0; f < set.face_count(); f += 7) {
      const auto c = set.face(f);
      slivers.points[c[0]] = 0.5f * (slivers.points[c[1]] + slivers.points[c[2]]);
    }
    for (Vec3& p : (shapes[name + std::string(", in a plane")] = set).points) p.z = 0.0f;
    for (Vec3& p : (shapes[name + std::string(", in a line")] = set).points) p = Vec3(p.x, -p.x, 3 * p.x);
    for (Vec3& p : (shapes[name + std::string(", in a point")] = set).points) p = Vec3(7.0f, -0.1f, 3e-20f);
    for (Vec3& p : (shapes[name + std::string(", of no size to speak of")] = set).points) p *= 1e-40f;
    for (Vec3& p : (shapes[name + std::string(", very large")] = set).points) p *= 0x1p56f;
  }
  return shapes;
}

void jitter(IndexedFaceSet& mesh, float amplitude, std::uint32_t seed) {
  // Not std::uniform_real_distribution: its values differ between standard libraries.
  std::mt19937 random(seed);
  const auto next = [&] { return (static_cast<float>(random() >> 8) / 8388608.0f - 1.0f) * amplitude; };
  for (Vec3& p : mesh.points) {
    p.x += next();
    p.y += next();
    p.z += next();
  }
}

std::vector<IndexedFaceSet> noisy_shapes() {
  std::vector<IndexedFaceSet> shapes = {icosphere(4), torus(40, 20), grid(20, 15), cylinder(10, 12), cube()};
  for (std::size_t i = 0; i < shapes.size(); ++i) jitter(shapes[i], 0.02f, static_cast<std::uint32_t>(i));
  return shapes;
}

HalfEdgeMesh half_edges(const IndexedFaceSet& mesh) {
  auto half_edges = to_half_edge_mesh(mesh);
  if (!half_edges) FAIL(half_edges.error().describe());
  return *std::move(half_edges);
}

}  // namespace vkmesh::test
