// Triangle and vertex normals against textbook formulas in double precision, written without regard to their
// order of operations.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/passes/triangle_normals.h>
#include <vkmesh/passes/vertex_normals.h>

#include "support/shapes.h"
#include "support/vectors.h"

using namespace vkmesh;
using test::angle_of;
using test::area_of;
using test::dot;
using test::length;

TEST_CASE("triangle normals agree with double precision, and are zero without area") {
  for (const IndexedFaceSet& set : test::noisy_shapes()) {
    const auto normals = triangle_normals(test::half_edges(set), set.points);
    REQUIRE(normals);
    REQUIRE(normals->size() == set.face_count());
    // As for vertex normals below.
    for (std::size_t f = 0; f < set.face_count(); ++f)
      CHECK(length(DVec3((*normals)[f]) - area_of(set, f) / length(area_of(set, f))) < 16 * 0x1p-21);
  }
  IndexedFaceSet line = test::grid(1, 1);
  for (Vec3& p : line.points) p = Vec3(p.x, p.x, p.x);
  const auto none = triangle_normals(test::half_edges(line), line.points);
  REQUIRE(none);
  for (const Vec3& n : *none) CHECK(n == Vec3(0.0f));
}

TEST_CASE("vertex normals agree with double precision, by area, by angle and uniform") {
  for (const NormalWeights weights : {NormalWeights::kArea, NormalWeights::kAngle, NormalWeights::kUniform})
    for (const IndexedFaceSet& set : test::noisy_shapes()) {
      const auto normals = vertex_normals(test::half_edges(set), set.points, {.weights = weights});
      REQUIRE(normals);
      std::vector<DVec3> expected(set.points.size(), DVec3(0.0));
      std::vector<double> magnitude(set.points.size(), 0.0);
      for (std::size_t f = 0; f < set.face_count(); ++f)
        for (std::size_t i = 0; i < 3; ++i) {
          const std::uint32_t v = set.face(f)[i];
          const DVec3 area = area_of(set, f);
          const double weight = weights == NormalWeights::kArea    ? 1.0
                                : weights == NormalWeights::kAngle ? angle_of(set, f, i) / length(area)
                                                                   : 1.0 / length(area);
          expected[v] += weight * area;
          magnitude[v] += weight * length(area);
        }
      for (std::size_t v = 0; v < expected.size(); ++v) {
        // Each area vector carries a few roundings of its products, at most 2^-21 of |a||b|, which these
        // shapes bound by four times the area; summing and normalising add as much again. Cancellation in the
        // sum magnifies it.
        const double tolerance = 16 * 0x1p-21 * magnitude[v] / length(expected[v]);
        CHECK(length(DVec3((*normals)[v]) - expected[v] / length(expected[v])) < tolerance);
      }
    }
}

TEST_CASE("vertex normals at the corners of a cube: by angle the diagonals, however its sides are cut") {
  const IndexedFaceSet set = test::cube();
  const HalfEdgeMesh mesh = test::half_edges(set);
  const auto apart = [&](NormalWeights weights) {
    const auto normals = vertex_normals(mesh, set.points, {.weights = weights}).value();
    double most = 0;
    for (std::size_t v = 0; v < normals.size(); ++v) {
      const DVec3 diagonal = DVec3(set.points[v]) - DVec3(0.5);
      most = std::max(most, length(DVec3(normals[v]) - diagonal / length(diagonal)));
    }
    return most;
  };
  // Angles of 45 and 90 degrees, and unit vectors, to a few ULP each.
  CHECK(apart(NormalWeights::kAngle) < 8 * 0x1p-23);
  CHECK(apart(NormalWeights::kArea) > 0.1);
  CHECK(apart(NormalWeights::kUniform) > 0.1);
}

TEST_CASE("vertex normals of a sphere point outward") {
  const IndexedFaceSet set = test::icosphere(5);
  const auto normals = vertex_normals(test::half_edges(set), set.points);
  REQUIRE(normals);
  // Area weights deviate from the true normal with the mesh's irregularity: first order in the edge length,
  // 0.035.
  for (std::size_t v = 0; v < set.points.size(); ++v)
    CHECK(length(DVec3((*normals)[v]) - DVec3(set.points[v])) < 0.01);
}

TEST_CASE("vertex normals are zero where no direction is defined") {
  IndexedFaceSet set = test::grid(1, 1);
  set.points.emplace_back(7.0f, 7.0f, 7.0f);  // isolated
  for (Vec3& p : set.points) p.x = 1.0f;      // all in one line's plane: still areas
  for (std::size_t i = 0; i < 4; ++i) set.points[i] = Vec3(1.0f, 2.0f, 3.0f);  // and now none
  for (const NormalWeights weights : {NormalWeights::kArea, NormalWeights::kAngle, NormalWeights::kUniform}) {
    const auto normals = vertex_normals(test::half_edges(set), set.points, {.weights = weights});
    REQUIRE(normals);
    for (const Vec3& n : *normals) CHECK(n == Vec3(0.0f));
  }
}

TEST_CASE("vertex normals do not depend on the unit of length, from nanometres to light years") {
  IndexedFaceSet set = test::icosphere(3);
  test::jitter(set, 0.05f, 9);
  const HalfEdgeMesh mesh = test::half_edges(set);
  const auto normals = vertex_normals(mesh, set.points);
  for (const float unit : {0x1p-30f, 0x1p-10f, 0x1p40f}) {
    std::vector<Vec3> scaled = set.points;
    for (Vec3& p : scaled) p *= unit;
    CHECK(vertex_normals(mesh, scaled).value() == normals.value());
  }
}

TEST_CASE("normals into memory of the caller are those of their own, whatever it held") {
  const IndexedFaceSet set = test::noisy_shapes().front();
  const HalfEdgeMesh sphere = test::half_edges(set);
  const Vec3 before(7.0f);
  std::vector<Vec3> at_faces(sphere.face_count(), before), at_vertices(sphere.vertex_count(), before);
  CHECK(triangle_normals(sphere, set.points, std::span(at_faces).first(5)).error().code == ErrorCode::kUsage);
  CHECK(vertex_normals(sphere, set.points, std::span(at_vertices).first(5)).error().code ==
        ErrorCode::kUsage);
  CHECK((at_faces[0] == before && at_vertices[0] == before));
  REQUIRE(triangle_normals(sphere, set.points, at_faces));
  CHECK(at_faces == triangle_normals(sphere, set.points).value());
  for (const NormalWeights weights : {NormalWeights::kArea, NormalWeights::kAngle, NormalWeights::kUniform}) {
    REQUIRE(vertex_normals(sphere, set.points, at_vertices, {weights}));
    CHECK(at_vertices == vertex_normals(sphere, set.points, {weights}).value());
  }
}

TEST_CASE("vertex normals of a cube of six quads are the diagonals, whichever corners come first") {
  const double expected = 1 / std::sqrt(3.0);
  for (std::uint32_t turns = 0; turns < 64; ++turns) {
    IndexedFaceSet set = test::quad_cube();
    for (std::uint32_t f = 0; f < 3; ++f) {
      const auto quad = set.corners.begin() + 4 * f;
      std::rotate(quad, quad + (turns >> (2 * f) & 3u), quad + 4);
    }
    const HalfEdgeMesh mesh = test::half_edges(set);
    for (const NormalWeights weights :
         {NormalWeights::kArea, NormalWeights::kAngle, NormalWeights::kUniform}) {
      const std::vector<Vec3> normals = vertex_normals(mesh, set.points, {weights}).value();
      for (std::size_t v = 0; v < normals.size(); ++v) {
        const DVec3 outward = 2.0 * DVec3(set.points[v]) - DVec3(1.0);
        CHECK(length(DVec3(normals[v]) - expected * outward) < 4 * 0x1p-23);
      }
    }
  }
}

TEST_CASE("vertex normals of polygons agree with double precision, whatever their shape") {
  // A prism over an L, walls of quads beside caps of six corners, one of them reflex; and the same bent.
  IndexedFaceSet prism;
  for (const float z : {0.0f, 1.0f})
    for (const auto& [x, y] : {std::pair(0, 0), {2, 0}, {2, 1}, {1, 1}, {1, 3}, {0, 3}})
      prism.points.emplace_back(static_cast<float>(x), static_cast<float>(y), z);
  prism.face_offsets = {0, 6, 12};
  prism.corners = {5, 4, 3, 2, 1, 0, 6, 7, 8, 9, 10, 11};
  for (std::uint32_t i = 0; i < 6; ++i) {
    prism.corners.insert(prism.corners.end(), {i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i});
    prism.face_offsets.push_back(static_cast<std::uint32_t>(prism.corners.size()));
  }
  IndexedFaceSet bent = prism;
  test::jitter(bent, 0.1f, 4);
  // One that mixes triangles with quads, in no order.
  IndexedFaceSet mixed = test::quad_cube();
  mixed.corners.insert(mixed.corners.end(), {mixed.corners[0], mixed.corners[2], mixed.corners[3]});
  mixed.corners.erase(mixed.corners.begin() + 3);
  mixed.face_offsets = {0, 3, 7, 11, 15, 19, 23, 26};
  test::jitter(mixed, 0.1f, 5);

  for (const IndexedFaceSet& set : {prism, bent, mixed})
    for (const NormalWeights weights :
         {NormalWeights::kArea, NormalWeights::kAngle, NormalWeights::kUniform}) {
      const auto normals = vertex_normals(test::half_edges(set), set.points, {weights});
      REQUIRE(normals);
      std::vector<DVec3> expected(set.points.size(), DVec3(0.0));
      for (std::size_t f = 0; f < set.face_count(); ++f) {
        const auto face = set.face(f);
        const auto at = [&](std::size_t i) { return DVec3(set.points[face[i % face.size()]]); };
        DVec3 newell(0.0);
        for (std::size_t i = 0; i < face.size(); ++i) newell += test::cross(at(i), at(i + 1));
        for (std::size_t i = 0; i < face.size(); ++i) {
          const DVec3 next = at(i + 1) - at(i), previous = at(i + face.size() - 1) - at(i);
          double angle = std::acos(dot(next, previous) / (length(next) * length(previous)));
          if (dot(test::cross(next, previous), newell) < 0) angle = 2 * 3.14159265358979 - angle;
          expected[face[i]] += weights == NormalWeights::kArea    ? newell
                               : weights == NormalWeights::kAngle ? angle / length(newell) * newell
                                                                  : newell / length(newell);
        }
      }
      for (std::size_t v = 0; v < expected.size(); ++v)
        CHECK(length(DVec3((*normals)[v]) - expected[v] / length(expected[v])) < 0x1p-18);
    }
}

TEST_CASE("vertex normals of triangles are the same bytes in a mesh of polygons") {
  for (const IndexedFaceSet& set : test::noisy_shapes()) {
    const HalfEdgeMesh mesh = test::half_edges(set);
    std::vector<std::uint32_t> offsets;
    for (std::uint32_t f = 0; f <= mesh.face_count(); ++f) offsets.push_back(3 * f);
    const auto copy = [](auto span) { return std::vector<std::uint32_t>(span.begin(), span.end()); };
    const HalfEdgeMesh polygons = HalfEdgeMesh::from_arrays(copy(mesh.origins()), copy(mesh.twins()),
                                                            copy(mesh.leadings()), std::move(offsets));
    for (const NormalWeights weights : {NormalWeights::kArea, NormalWeights::kAngle, NormalWeights::kUniform})
      CHECK(vertex_normals(polygons, set.points, {weights}).value() ==
            vertex_normals(mesh, set.points, {weights}).value());
  }
}
