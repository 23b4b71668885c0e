// Fuzzes constrained_delaunay() over random points, constraints, outlines and refinements: it always ends,
// the triangles are those of a constrained Delaunay triangulation, and constraints go from end to end.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/planar/constrained_delaunay.h>

#include "check.h"
#include "near_segment.h"
#include "random_manifold.h"

namespace vkmesh::fuzz {
namespace {

/// Whole numbers, so that many points are collinear and cocircular, also as the least numbers there are or
/// just off; or doubles of any size.
double coordinate(Bytes& bytes, std::uint8_t kind) {
  const std::uint8_t value = bytes.next();
  switch (kind % 8) {
    case 0:
    case 1:
      return value % 8;
    case 2:
      return std::nextafter(value % 8, value < 128 ? -100 : 100);
    case 3:
      return (value % 32) * std::numeric_limits<double>::denorm_min();
    case 4:
      return 1e6 + value * 0.01;
    case 5:
      return std::ldexp(value - 128.0, bytes.next() % 100 - 50);
    case 6:
      return std::ldexp(value / 3.0, bytes.next() * 8 - 1070);
    default:
      return value / 255.0 + bytes.next() / 65536.0;
  }
}

using Edges = std::set<PointPair>;

void check_triangles(const ConstrainedTriangulation& of, const Edges& kept) {
  require(validate(of.mesh).has_value(), "the half-edges are valid");
  const HalfEdgeMesh& mesh = of.mesh;
  const auto at = [&](VertexId v) { return of.positions[v.index]; };
  for (std::uint32_t i = 0; i < mesh.half_edge_count(); ++i) {
    const HalfEdgeId h(i);
    const VertexId a = mesh.origin(h), b = mesh.target(h), c = mesh.origin(mesh.previous(h));
    require(orientation(at(a), at(b), at(c)) > 0, "triangles turn counter-clockwise");
    if (mesh.is_boundary(h) || kept.contains({a.index, b.index})) continue;
    require(in_circle_perturbed(at(a), at(b), at(c), at(mesh.origin(mesh.previous(mesh.twin(h))))) < 0,
            "edges that are no constraints are Delaunay");
  }
}

/// Edges of constraints from a to b, along the segment.
bool has_chain(const ConstrainedTriangulation& of, const Edges& kept, std::uint32_t a, std::uint32_t b) {
  const auto& p = of.positions;
  std::set<std::uint32_t> reached = {a};
  std::vector<std::uint32_t> waiting = {a};
  while (!waiting.empty()) {
    const std::uint32_t v = waiting.back();
    waiting.pop_back();
    if (v == b) return true;
    for (auto e = kept.lower_bound({v, 0}); e != kept.end() && (*e)[0] == v; ++e) {
      const std::uint32_t w = (*e)[1];
      if (is_near_segment(p[w], p[a], p[b]) && reached.insert(w).second) waiting.push_back(w);
    }
  }
  return false;
}

void fuzz(std::span<const std::uint8_t> all) {
  Bytes bytes(all);
  std::vector<DVec2> points;
  const std::uint8_t kind = bytes.next();
  for (std::uint32_t left = bytes.below(64); left > 0; --left) {
    const double x = coordinate(bytes, kind);
    points.emplace_back(x, coordinate(bytes, kind));
  }
  std::vector<PointPair> constraints, outlines;
  const std::size_t range = points.size() + (bytes.next() % 32 == 0 ? 1 : 0);
  for (std::uint32_t left = range == 0 ? 0 : bytes.below(24); left > 0; --left)
    constraints.push_back({bytes.below(range), bytes.below(range)});
  for (std::uint32_t loops = points.empty() ? 0 : bytes.below(4); loops > 0; --loops) {
    const std::uint32_t first = bytes.below(points.size());
    std::uint32_t last = first;
    for (std::uint32_t left = 2 + bytes.below(6); left > 0; --left) {
      const std::uint32_t next = left == 1 ? first : bytes.below(points.size());
      outlines.push_back({last, next});
      last = next;
    }
  }
  ConstrainedDelaunayOptions options;
  options.outlines = outlines;
  options.domain = static_cast<DelaunayDomain>(bytes.next() % 3);
  const std::uint8_t how = bytes.next();
  options.split_crossings = how % 4 != 0;
  if (how / 4 % 2 == 0) {
    DelaunayRefinement& refinement = options.refinement.emplace();
    constexpr std::array<double, 4> kAngles = {0, 0.36, 0.5, 0.9};
    refinement.min_angle = kAngles[how / 8 % 4];
    if (how / 32 % 2 == 0) refinement.max_area = std::ldexp(1.0, bytes.next() % 40 - 30);
    if (how / 64 % 2 == 0) refinement.min_edge = 1e-3;
    refinement.max_points = bytes.below(400);
  }
  const auto made = constrained_delaunay(points, constraints, options);
  if (!made) {
    require(made.error().code == ErrorCode::kUnsuitable && !made.error().message.empty(),
            "refused for a reason");
    require(!options.split_crossings || made.error().message.find("crosses constraint") == std::string::npos,
            "crossings are split on request");
    return;
  }
  Edges kept;
  for (const HalfEdgeId h : made->constrained_edges) {
    const std::uint32_t a = made->mesh.origin(h).index, b = made->mesh.target(h).index;
    kept.insert({a, b});
    kept.insert({b, a});
  }
  check_triangles(*made, kept);
  require(made->positions.size() == made->mesh.vertex_count() &&
              made->point_of_vertex.size() == made->mesh.vertex_count() &&
              made->vertex_of_point.size() == points.size(),
          "the arrays fit the mesh");
  for (std::size_t i = 0; i < made->added.size(); ++i)
    for (const std::uint32_t v : made->added[i].vertices)
      require(v < made->positions.size() - made->added.size() + i,
              "added vertices lie between others before them");
  for (const UnrefinedTriangle& t : made->unrefined)
    require(t.face.index < made->mesh.face_count(), "triangles that are left are of the mesh");
  if (options.refinement)
    require(made->refined_points <= *options.refinement->max_points, "no more points than allowed");
  if (options.domain == DelaunayDomain::kConvexHull && made->mesh.face_count() > 0)
    for (const auto* segments : {&constraints, &outlines})
      for (const auto& [a, b] : *segments)
        require(has_chain(*made, kept, made->vertex_of_point[a], made->vertex_of_point[b]),
                "constraints go from end to end");
  std::reverse(constraints.begin(), constraints.end());
  const auto again = constrained_delaunay(points, constraints, options);
  require(again.has_value() && again->positions == made->positions &&
              std::ranges::equal(again->mesh.origins(), made->mesh.origins()) &&
              again->constrained_edges == made->constrained_edges,
          "the order of constraints does not count");
}

}  // namespace
}  // namespace vkmesh::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vkmesh::fuzz::fuzz(std::span(data, size));
  return 0;
}
