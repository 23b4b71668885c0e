// Index buffers that are no oriented manifolds, and vertex buffers of engines.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <vkmesh/decimation/decimate_index_buffer.h>

#include "support/shapes.h"
#include "support/vectors.h"

namespace vkmesh::test {
namespace {

DecimatedIndexBuffer decimate_indices(const IndexedFaceSet& mesh, const DecimateOptions& options) {
  auto result = decimate_index_buffer(mesh.points, mesh.corners, options);
  if (!result) FAIL(result.error().describe());
  REQUIRE(result->indices.size() == 3 * result->source_face.size());
  for (const std::uint32_t v : result->indices) REQUIRE(v < mesh.points.size());
  return *std::move(result);
}

std::size_t faces_of(const DecimatedIndexBuffer& buffer) {
  return buffer.source_face.size();
}

DecimateOptions to_ratio(double ratio) {
  DecimateOptions options;
  options.target.ratio = ratio;
  return options;
}

using Place = std::array<float, 3>;

Place place_of(const IndexedFaceSet& mesh, std::uint32_t vertex) {
  const Vec3 p = mesh.points[vertex];
  return {p.x, p.y, p.z};
}

std::set<Place> places_of(const IndexedFaceSet& mesh, const std::vector<std::uint32_t>& indices) {
  std::set<Place> places;
  for (const std::uint32_t v : indices) places.insert(place_of(mesh, v));
  return places;
}

/// For each edge between places how many more triangles run one way than the other: the boundary of a surface
/// as a chain. Empty where it is closed.
std::map<std::pair<Place, Place>, int> boundary_of(const IndexedFaceSet& mesh,
                                                   const std::vector<std::uint32_t>& indices) {
  std::map<std::pair<Place, Place>, int> boundary;
  for (std::size_t c = 0; c < indices.size(); ++c) {
    const Place a = place_of(mesh, indices[c]), b = place_of(mesh, indices[c % 3 == 2 ? c - 2 : c + 1]);
    boundary[std::minmax(a, b)] += a < b ? 1 : -1;
  }
  std::erase_if(boundary, [](const auto& edge) { return edge.second == 0; });
  return boundary;
}

double area_of(const IndexedFaceSet& mesh, const std::vector<std::uint32_t>& indices) {
  double area = 0;
  for (std::size_t c = 0; c < indices.size(); c += 3) {
    const DVec3 p(mesh.points[indices[c]]), q(mesh.points[indices[c + 1]]), r(mesh.points[indices[c + 2]]);
    area += 0.5 * glm::length(glm::cross(q - p, r - p));
  }
  return area;
}

IndexedFaceSet turned(IndexedFaceSet mesh) {
  for (std::size_t f = 0; f < mesh.corners.size(); f += 3)
    std::swap(mesh.corners[f + 1], mesh.corners[f + 2]);
  return mesh;
}

}  // namespace

TEST_CASE("the default operation is taken, as a half-edge collapse; vertex removals are taken, too",
          "[decimate]") {
  IndexedFaceSet mesh = torus(40, 24);
  jitter(mesh, 0.01f, 1);
  DecimateOptions options = to_ratio(0.2);
  const DecimatedIndexBuffer by_default = decimate_indices(mesh, options);
  options.operation = DecimateOperation::kHalfEdgeCollapse;
  CHECK(by_default.indices == decimate_indices(mesh, options).indices);
  CHECK(faces_of(by_default) <= mesh.face_count() / 5);
  options.operation = DecimateOperation::kVertexRemoval;
  const DecimatedIndexBuffer removed = decimate_indices(mesh, options);
  CHECK(faces_of(removed) <= mesh.face_count() / 5);
  CHECK(removed.indices != by_default.indices);
  CHECK(boundary_of(mesh, removed.indices).empty());
}

TEST_CASE("a fin stays on its surface, and both are simplified", "[decimate]") {
  // It stands on the middle line of a grid, whose vertices it has, or has copies of.
  for (const bool own_vertices : {true, false}) {
    IndexedFaceSet mesh = grid(20, 20);
    IndexedFaceSet fin = grid(20, 6);
    for (Vec3& p : fin.points) p = Vec3(p.x, 10.0f, p.y);
    std::vector<std::uint32_t> vertex_of;
    for (const Vec3& p : fin.points) {
      if (p.z == 0.0f && !own_vertices) {
        vertex_of.push_back(static_cast<std::uint32_t>(10 * 21 + p.x));
        REQUIRE(mesh.points[vertex_of.back()] == p);
      } else {
        vertex_of.push_back(static_cast<std::uint32_t>(mesh.points.size()));
        mesh.points.push_back(p);
      }
    }
    for (const std::uint32_t c : fin.corners) mesh.corners.push_back(vertex_of[c]);
    const DecimatedIndexBuffer result = decimate_indices(mesh, to_ratio(0.2));
    CHECK(faces_of(result) <= mesh.face_count() / 5);
    const std::set<Place> places = places_of(mesh, result.indices);
    for (int x = 0; x <= 20; ++x) CHECK(places.contains({static_cast<float>(x), 10.0f, 0.0f}));
    CHECK(area_of(mesh, result.indices) == Approx(400 + 120));
  }
}

TEST_CASE("a turned triangle stays, and all else is simplified", "[decimate]") {
  IndexedFaceSet mesh = icosphere(4);
  std::swap(mesh.corners[3 * 1000], mesh.corners[3 * 1000 + 1]);
  const DecimatedIndexBuffer result = decimate_indices(mesh, to_ratio(0.05));
  CHECK(faces_of(result) <= mesh.face_count() / 20);
  CHECK(std::count(result.source_face.begin(), result.source_face.end(), 1000u) == 1);
  CHECK(boundary_of(mesh, result.indices) == boundary_of(mesh, mesh.corners));
}

/// The mesh and its reverse, over the same points or over copies of them.
std::vector<IndexedFaceSet> double_sided(const IndexedFaceSet& front) {
  IndexedFaceSet shared = front;
  for (const std::uint32_t c : turned(front).corners) shared.corners.push_back(c);
  return {shared, both(front, turned(front))};
}

TEST_CASE("the sides of a double-sided part are simplified each by itself", "[decimate]") {
  const IndexedFaceSet flat = grid(20, 20), ball = icosphere(3);
  for (const IndexedFaceSet& mesh : double_sided(flat)) {
    const DecimatedIndexBuffer result = decimate_indices(mesh, to_ratio(0.05));
    CHECK(faces_of(result) <= mesh.face_count() / 20);
    CHECK(area_of(mesh, result.indices) == Approx(800));
  }
  for (const IndexedFaceSet& mesh : double_sided(ball)) {
    const DecimatedIndexBuffer result = decimate_indices(mesh, to_ratio(0.1));
    CHECK(faces_of(result) <= mesh.face_count() / 10);
    CHECK(boundary_of(mesh, result.indices).empty());
    const auto front = static_cast<double>(std::ranges::lower_bound(result.source_face, ball.face_count()) -
                                           result.source_face.begin());
    CHECK(front == Approx(0.05 * static_cast<double>(mesh.face_count())).epsilon(0.1));
  }
  // Two cards that cross have no edge in common: nothing of them is locked.
  IndexedFaceSet across = flat;
  for (Vec3& p : across.points) p = Vec3(p.x, 9.5f, p.y - 9.5f);
  const IndexedFaceSet leaf = both(flat, across);
  CHECK(faces_of(decimate_indices(leaf, to_ratio(0.01))) <= 16);
}

TEST_CASE("parts that touch in a point still do", "[decimate]") {
  const IndexedFaceSet square = grid(12, 12);
  const IndexedFaceSet mesh = both(square, square, Vec3(12, 12, 0));
  const DecimatedIndexBuffer result = decimate_indices(mesh, to_ratio(0.0));
  CHECK(faces_of(result) <= 8);
  std::size_t at_point = 0;
  for (const std::uint32_t v : result.indices) at_point += mesh.points[v] == Vec3(12, 12, 0) ? 1 : 0;
  CHECK(at_point >= 2);
}

TEST_CASE("closed parts stay closed, however they touch", "[decimate]") {
  std::mt19937 engine(5);
  const auto below = [&](std::uint32_t count) { return static_cast<std::uint32_t>(engine() % count); };
  for (int round = 0; round < 30; ++round) {
    // Cubes of a lattice: they have walls, edges and corners in common. Their vertices are shared, or not.
    IndexedFaceSet mesh;
    std::set<std::array<std::uint32_t, 3>> cells;
    for (std::uint32_t i = 2 + below(8); i > 0; --i) cells.insert({below(2), below(2), below(3)});
    for (const auto& [x, y, z] : cells) mesh = both(mesh, fine_cube(4), Vec3(x, y, z));
    if (round % 2 == 1) {
      std::map<Place, std::uint32_t> first;
      for (std::uint32_t& c : mesh.corners) c = first.try_emplace(place_of(mesh, c), c).first->second;
    }
    REQUIRE(boundary_of(mesh, mesh.corners).empty());
    for (const auto operation : {DecimateOperation::kHalfEdgeCollapse, DecimateOperation::kVertexRemoval}) {
      DecimateOptions options = to_ratio(0.1);
      options.operation = operation;
      options.bounds.error =
          Length::absolute(1e-4);  // where edges of several cubes are locked, more is out of reach
      const DecimatedIndexBuffer result = decimate_indices(mesh, options);
      CHECK(boundary_of(mesh, result.indices).empty());
      CHECK(faces_of(result) < mesh.face_count() / 2);
      CHECK(area_of(mesh, result.indices) == Approx(6.0 * static_cast<double>(cells.size())));
    }
  }
}

TEST_CASE("any triangles over few points are taken", "[decimate]") {
  std::mt19937 engine(9);
  const auto below = [&](std::uint32_t count) { return static_cast<std::uint32_t>(engine() % count); };
  for (int round = 0; round < 2000; ++round) {
    IndexedFaceSet mesh;
    const std::uint32_t places = 4 + below(6), points = places + below(6);
    for (std::uint32_t p = 0; p < points; ++p) {
      const std::uint32_t q = p % places;
      mesh.points.emplace_back(static_cast<float>(q % 3), static_cast<float>(q * q % 5),
                               static_cast<float>(q * 7 % 4));
    }
    for (std::uint32_t c = 3 * below(24); c > 0; --c) mesh.corners.push_back(below(points));
    const DecimatedIndexBuffer result = decimate_indices(mesh, to_ratio(0.3));
    // An odd number of three or more faces cannot be paired: the ends of such an edge stay.
    std::map<std::pair<Place, Place>, int> faces;
    for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
      const std::size_t f = c - c % 3;
      const Place a = place_of(mesh, mesh.corners[f]), b = place_of(mesh, mesh.corners[f + 1]),
                  d = place_of(mesh, mesh.corners[f + 2]);
      if (a == b || b == d || d == a) continue;
      ++faces[std::minmax(place_of(mesh, mesh.corners[c]),
                          place_of(mesh, mesh.corners[c == f + 2 ? f : c + 1]))];
    }
    const std::set<Place> left = places_of(mesh, result.indices);
    for (const auto& [edge, count] : faces)
      if (count >= 3 && count % 2 == 1) CHECK((left.contains(edge.first) && left.contains(edge.second)));
  }
}

TEST_CASE("vertices of an interleaved buffer are read where they lie", "[decimate]") {
  IndexedFaceSet mesh = torus(40, 24);
  jitter(mesh, 0.01f, 3);
  std::vector<float> uv;
  for (const Vec3& p : mesh.points) uv.insert(uv.end(), {p.x * 3.0f, p.y - p.z});
  DecimateOptions options = to_ratio(0.1);
  options.attributes = {{2, uv, {}, 0.5, AttributeKind::kPlain}};
  const DecimatedIndexBuffer wanted = decimate_indices(mesh, options);
  CHECK(wanted.attribute_error > 0);
  for (const std::size_t stride : {12u, 13u, 16u, 20u, 32u, 44u}) {
    INFO("a stride of " << stride << " bytes");
    const bool with_uv = stride >= 20 && stride % 4 == 0;
    // What is not ours is full of NaN.
    std::vector<float> buffer((stride * mesh.points.size() + 3) / 4 + 1,
                              std::numeric_limits<float>::quiet_NaN());
    auto* bytes = reinterpret_cast<std::byte*>(buffer.data());
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
      std::memcpy(bytes + stride * v, &mesh.points[v], 12);
      if (with_uv) std::memcpy(bytes + stride * v + stride - 8, &uv[2 * v], 8);
    }
    options.attributes[0].values = uv;
    options.attributes[0].stride = 0;
    if (with_uv) {
      options.attributes[0].values =
          std::span(buffer).subspan((stride - 8) / 4, (stride / 4) * (mesh.points.size() - 1) + 2);
      options.attributes[0].stride = static_cast<std::uint32_t>(stride / 4);
    }
    const auto result =
        decimate_index_buffer(StridedSpan<Vec3>(bytes, mesh.points.size(), stride), mesh.corners, options);
    if (!result) FAIL(result.error().describe());
    CHECK(result->indices == wanted.indices);
    CHECK(result->attribute_error == wanted.attribute_error);
  }
  options.attributes[0].stride = 1;
  CHECK(decimate_index_buffer(mesh.points, mesh.corners, options).error().code == ErrorCode::kUsage);
}

}  // namespace vkmesh::test
