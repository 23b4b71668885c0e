// Fuzzes delaunay() and voronoi() over random points, many of them equal, collinear, cocircular or nearly so:
// each triangulation is Delaunay by the exact predicates, and each diagram tiles the polygon.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/indexed_face_set.h>
#include <vkmesh/planar/delaunay.h>
#include <vkmesh/planar/voronoi.h>
#include <vkmesh/repair/consolidate.h>

#include "check.h"
#include "random_manifold.h"

namespace vkmesh::fuzz {
namespace {

double any_double(Bytes& bytes) {
  std::array<std::uint8_t, 8> raw{};
  for (std::uint8_t& byte : raw) byte = bytes.next();
  double value = 0;
  std::memcpy(&value, raw.data(), sizeof value);
  return value;
}

/// Whole numbers, those with a last bit more or less, halves of either, or any doubles.
double coordinate(Bytes& bytes, std::uint32_t kind) {
  const std::uint8_t byte = bytes.next();
  double x = byte % 16;
  if (kind == 3 && byte >= 224) return any_double(bytes);
  if (kind >= 1 && byte >= 128) x = std::nextafter(x, byte >= 192 ? 1e300 : -1e300);
  if (kind == 2) x *= 0.5;
  return x;
}

std::vector<DVec2> points_of(Bytes& bytes, std::size_t most) {
  const std::uint32_t kind = bytes.below(4);
  const int exponent = kind == 3 ? static_cast<int>(bytes.below(2100)) - 1070 : 0;
  std::vector<DVec2> points;
  while (!bytes.empty() && points.size() < most) {
    const double x = std::ldexp(coordinate(bytes, kind), exponent);
    points.emplace_back(x, std::ldexp(coordinate(bytes, kind), exponent));
  }
  return points;
}

void check_delaunay(const std::vector<DVec2>& points, const DelaunayTriangulation& made) {
  const HalfEdgeMesh& mesh = made.mesh;
  require(validate(mesh).has_value(), "the half-edges are valid");
  const auto at = [&](VertexId v) { return points[made.point_of_vertex[v.index]]; };
  for (std::uint32_t i = 0; i < mesh.half_edge_count(); ++i) {
    const HalfEdgeId h(i), twin = mesh.twin(h), next = mesh.next(h);
    require(orientation(at(mesh.origin(h)), at(mesh.target(h)), at(mesh.target(next))) > 0,
            "triangles turn counter-clockwise");
    require(!twin.valid() || in_circle_perturbed(at(mesh.origin(h)), at(mesh.target(h)),
                                                 at(mesh.target(next)), at(mesh.target(mesh.next(twin)))) < 0,
            "edges are Delaunay");
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    require(points[made.point_of_vertex[made.vertex_of_point[i]]] == points[i], "each point has its vertex");
}

void check_voronoi(const VoronoiDiagram& diagram, std::size_t points, const std::vector<DVec2>& clip) {
  require(diagram.site_of_point.size() == points && diagram.neighbours.size() == diagram.corners.size() &&
              diagram.cell_offsets.size() == diagram.cell_count() + 1,
          "the arrays fit");
  IndexedFaceSet set;
  set.points.resize(diagram.vertices.size());
  set.corners = diagram.corners;
  set.face_offsets = {0};
  std::vector<std::uint32_t> cell_of_face;
  double sum = 0, area = 0;
  for (std::uint32_t i = 0; i < diagram.cell_count(); ++i) {
    require(std::isfinite(diagram.sites[i].x) && std::isfinite(diagram.sites[i].y), "sites are finite");
    if (diagram.cell(i).empty()) continue;
    sum += diagram.area(i);
    set.face_offsets.push_back(diagram.cell_offsets[i + 1]);
    cell_of_face.push_back(i);
  }
  const auto mesh = to_half_edge_mesh(set);
  require(mesh.has_value() && validate(*mesh).has_value(), "cells are the faces of a manifold");
  require(mesh->boundary_loops().size() == 1 &&
              mesh->vertex_count() + mesh->face_count() == mesh->edge_count() + 1,
          "cells make up one disk");
  for (std::uint32_t h = 0; h < mesh->half_edge_count(); ++h) {
    const HalfEdgeId twin = mesh->twin(HalfEdgeId(h));
    require(diagram.neighbours[h] == (twin.valid() ? cell_of_face[mesh->face(twin).index] : kInvalid),
            "neighbours are across edges");
  }
  for (const DVec2 p : diagram.vertices)
    require(std::isfinite(p.x) && std::isfinite(p.y), "vertices are finite");
  // Vertices on sides are rounded: what that takes of the area grows with the length of the sides.
  double length = 0, largest = 0;
  for (std::size_t i = 0; i < clip.size(); ++i) {
    const DVec2 a = clip[i] - clip[0], b = clip[(i + 1) % clip.size()] - clip[0];
    area += 0.5 * (a.x * b.y - a.y * b.x);
    length += std::hypot(b.x - a.x, b.y - a.y);
    largest = std::max({largest, std::fabs(clip[i].x), std::fabs(clip[i].y)});
  }
  const double slack = 1e-11 * std::fabs(area) + 0x1p-46 * largest * length;
  if (std::isfinite(slack) && slack > 1e-280)
    require(std::fabs(sum - std::fabs(area)) <= slack, "areas add up");
}

void fuzz(std::span<const std::uint8_t> all) {
  Bytes bytes(all);
  VoronoiOptions options;
  options.lloyd_iterations = bytes.below(8) < 6 ? 0 : 2;
  const std::uint8_t how = bytes.next();
  if (how % 4 == 0)
    for (std::uint32_t corners = 3 + bytes.below(3); corners > 0; --corners) {
      const double x = coordinate(bytes, how / 4 % 4);
      options.clip.emplace_back(x, coordinate(bytes, how / 4 % 4));
    }
  const std::vector<DVec2> points = points_of(bytes, 300);
  const auto made = delaunay(points);
  const auto diagram = voronoi(points, options);
  if (!made) {
    require(made.error().code == ErrorCode::kUnsuitable && !diagram, "only what is not finite is refused");
    return;
  }
  check_delaunay(points, *made);
  if (!diagram) {
    require(diagram.error().code == ErrorCode::kUnsuitable && !options.clip.empty(), "a polygon is refused");
    return;
  }
  if (diagram->cell_count() > 0)
    check_voronoi(*diagram, points.size(), options.clip.empty() ? bounds_of_sites(points) : options.clip);
}

}  // namespace
}  // namespace vkmesh::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vkmesh::fuzz::fuzz(std::span(data, size));
  return 0;
}
