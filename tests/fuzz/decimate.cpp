// Fuzzes decimate() over random manifolds: after every operation the surface is a manifold of the same
// topology, and whatever the result says of itself holds.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/consolidate.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/topology.h>

#include "check.h"
#include "random_manifold.h"

namespace vkmesh::fuzz {
namespace {

template <class Point>
struct Input {
  HalfEdgeMesh mesh;
  std::vector<Point> points;
  std::vector<std::uint32_t> corners;
  SurfaceTopology topology;
  std::size_t used = 0;  // vertices of faces
};

SurfaceTopology topology_of(std::size_t points, std::span<const std::uint32_t> corners) {
  IndexedFaceSet mesh;
  mesh.points.resize(points);
  mesh.corners.assign(corners.begin(), corners.end());
  auto topology = surface_topology(mesh);
  require(topology.has_value(), "any face set has a topology");
  return std::move(*topology);
}

std::vector<std::uint32_t> some_of(Bytes& bytes, std::size_t count) {
  std::vector<std::uint32_t> some;
  const std::uint8_t how = bytes.next();
  if (how % 4 != 0 || count == 0) return some;
  for (std::size_t left = how / 4 % 16; left > 0; --left) some.push_back(bytes.below(count));
  return some;
}

template <class Point>
DecimateOptions options_of(Bytes& bytes, const Input<Point>& input) {
  DecimateOptions options;
  options.keep_history = true;
  options.operation = std::array{DecimateOperation::kEdgeCollapse, DecimateOperation::kHalfEdgeCollapse,
                                 DecimateOperation::kVertexRemoval}[bytes.next() % 3];
  options.placement = std::array{CollapsePlacement::kOptimal, CollapsePlacement::kMidpoint,
                                 CollapsePlacement::kEndpoint}[bytes.next() % 3];
  options.boundary = std::array{DecimateBoundary::kInShape, DecimateBoundary::kFree,
                                DecimateBoundary::kKept}[bytes.next() % 3];
  options.boundary_weight = std::array{10.0, 0.0, 1e6, 1e-6}[bytes.next() % 4];
  options.max_normal_deviation = std::array{1.3, 1.3, 0.1, 3.14}[bytes.next() % 4];
  const std::uint8_t crease = bytes.next();
  if (crease % 4 == 0) options.crease_angle = 0.01 + crease / 100.0;
  if (crease % 8 == 0) options.crease_weight = 1e4;
  const std::uint8_t bound = bytes.next();
  if (bound % 4 == 1) options.max_relative_error = bound / 4 / 640.0;
  if (bound % 4 == 2) options.max_error = std::ldexp(1.0, bound / 4 - 32);
  const std::uint8_t prune = bytes.next();
  if (prune % 8 == 1) options.prune_relative_size = prune / 256.0;
  options.locked_vertices = some_of(bytes, input.points.size());
  options.locked_edges = some_of(bytes, input.corners.size());
  options.locked_faces = some_of(bytes, input.corners.size() / 3);
  return options;
}

template <class Point>
bool same_place(const Point& a, const Point& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// The same manifold but for what was pruned, component by component.
template <class Point>
void require_same_topology(const BasicDecimated<Point>& result, const Input<Point>& input) {
  const SurfaceTopology after = topology_of(result.mesh.vertex_count(), result.mesh.origins());
  require(after.whole.manifold() && after.whole.oriented(), "an oriented manifold is left");
  require(after.components.size() + result.pruned_components == input.topology.components.size(),
          "components stay apart, and none goes unless pruned");
  std::vector<bool> seen(input.topology.components.size(), false);
  for (std::size_t f = 0; f < result.mesh.face_count(); ++f) {
    const std::uint32_t from = input.topology.component_of_face[result.source_face[f]];
    const Topology &was = input.topology.components[from], &is = after.components[after.component_of_face[f]];
    require(was.euler_characteristic() == is.euler_characteristic(), "the Euler characteristic stays");
    require(was.boundary_loops == is.boundary_loops, "boundary loops stay");
    seen[from] = true;
  }
  require(static_cast<std::size_t>(std::count(seen.begin(), seen.end(), true)) == after.components.size(),
          "each component comes from one of its own");
}

template <class Point>
void require_maps(const BasicDecimated<Point>& result, const Input<Point>& input,
                  const DecimateOptions& options) {
  const std::size_t vertices = result.mesh.vertex_count(), faces = result.mesh.face_count();
  require(result.positions.size() == vertices && result.source_vertex.size() == vertices &&
              result.source_face.size() == faces && result.vertex_map.size() == input.points.size(),
          "arrays fit");
  require(std::is_sorted(result.source_vertex.begin(), result.source_vertex.end(), std::less_equal<>()) &&
              std::is_sorted(result.source_face.begin(), result.source_face.end(), std::less_equal<>()),
          "sources ascend");
  for (std::size_t v = 0; v < input.points.size(); ++v) {
    const std::uint32_t to = result.vertex_map[v];
    require(to < vertices || to == kInvalid, "the vertex map names vertices");
    if (options.prune_relative_size) continue;
    require((to == kInvalid) == input.mesh.is_isolated(VertexId(static_cast<std::uint32_t>(v))),
            "every vertex but isolated ones has one that stands for it");
  }
  const bool keeps_places = options.operation != DecimateOperation::kEdgeCollapse;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const Point& p = result.positions[v];
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "positions are finite");
    require(!result.mesh.is_isolated(VertexId(v)), "no vertex is isolated");
    require(result.source_vertex[v] < input.points.size() && result.vertex_map[result.source_vertex[v]] == v,
            "vertices stand for their sources");
    if (keeps_places) require(same_place(p, input.points[result.source_vertex[v]]), "places are kept");
  }
  if (options.operation == DecimateOperation::kVertexRemoval) return;  // its faces are new ones
  for (std::size_t f = 0; f < faces; ++f)
    for (std::size_t i = 0; i < 3; ++i)
      require(
          result.vertex_map[input.corners[3 * result.source_face[f] + i]] == result.mesh.origins()[3 * f + i],
          "faces keep their corners");
}

template <class Point>
void require_locks(const BasicDecimated<Point>& result, const Input<Point>& input,
                   const DecimateOptions& options) {
  if (options.prune_relative_size) return;  // what is locked may be pruned
  const auto require_vertex = [&](std::uint32_t v) {
    const std::uint32_t to = result.vertex_map[v];
    if (to == kInvalid) return;  // isolated
    require(result.source_vertex[to] == v && same_place(result.positions[to], input.points[v]),
            "locked vertices stay");
  };
  const auto require_edge = [&](std::uint32_t h) {
    const std::uint32_t a = input.corners[h], b = input.corners[h % 3 == 2 ? h - 2 : h + 1];
    require_vertex(a);
    require_vertex(b);
    const VertexId p(result.vertex_map[a]), q(result.vertex_map[b]);
    require(result.mesh.find_half_edge(p, q).valid() || result.mesh.find_half_edge(q, p).valid(),
            "locked edges stay");
  };
  for (const std::uint32_t v : options.locked_vertices) require_vertex(v);
  for (const std::uint32_t h : options.locked_edges) require_edge(h);
  for (const std::uint32_t f : options.locked_faces)
    for (std::uint32_t i = 0; i < 3; ++i) require_edge(3 * f + i);
  if (options.boundary != DecimateBoundary::kKept) return;
  for (std::uint32_t h = 0; h < input.corners.size(); ++h)
    if (input.mesh.is_boundary(HalfEdgeId(h))) require_edge(h);
  require(result.mesh.boundary_half_edge_count() == input.mesh.boundary_half_edge_count(),
          "a boundary that is kept stays");
}

/// The history, done again, gives the same vertices at the same places.
template <class Point>
void require_history(const BasicDecimated<Point>& result, const Input<Point>& input) {
  require(result.history.size() == result.collapses, "every operation is in the history");
  std::vector<std::uint32_t> by(input.points.size(), kInvalid);
  std::vector<Point> places = input.points;
  for (const Collapse<Point>& c : result.history) {
    require(c.kept < by.size() && c.removed < by.size() && c.kept != c.removed, "the history names vertices");
    require(by[c.kept] == kInvalid && by[c.removed] == kInvalid, "both were there");
    by[c.removed] = c.kept;
    places[c.kept] = c.position;
  }
  for (std::uint32_t v = 0; v < by.size(); ++v) {
    std::uint32_t at = v;
    while (by[at] != kInvalid) at = by[at];
    require(result.vertex_map[at] == result.vertex_map[v], "the history and the vertex map agree");
    if (result.vertex_map[at] == kInvalid) continue;
    require(result.source_vertex[result.vertex_map[at]] == at, "the history and the sources agree");
    require(same_place(places[at], result.positions[result.vertex_map[at]]),
            "the history and the places agree");
  }
}

template <class Point>
void require_stop(const BasicDecimated<Point>& result, const Input<Point>& input,
                  const DecimateOptions& options) {
  const std::size_t vertices = result.mesh.vertex_count(), faces = result.mesh.face_count();
  const std::size_t most_faces = options.target_faces.value_or(0),
                    most_vertices = options.target_vertices.value_or(0);
  const bool reached = faces <= most_faces || vertices <= most_vertices;
  require(reached == (result.stop == DecimateStop::kTargetReached), "it says whether a target was reached");
  if (result.collapses > 0)
    require(faces + 1 >= most_faces && vertices >= most_vertices, "no target is undershot");
  require(std::isfinite(result.error) && result.error >= 0, "the error is a number");
  constexpr double kRounding = 1 + 1e-6;
  if (options.max_error) require(result.error <= kRounding * *options.max_error, "max_error holds");
  if (options.max_relative_error)
    require(result.relative_error <= kRounding * *options.max_relative_error, "max_relative_error holds");
  if (!options.prune_relative_size)
    require(vertices + result.collapses == input.used, "an operation takes one vertex");
}

/// The signed area of a face seen from above, doubled, as a share of its squared sides.
template <class Point>
double area_from_above(const Point& a, const Point& b, const Point& c) {
  const auto from = [](const Point& p, const Point& q) {
    return std::array{static_cast<double>(q.x) - static_cast<double>(p.x),
                      static_cast<double>(q.y) - static_cast<double>(p.y)};
  };
  const auto u = from(a, b), v = from(a, c), w = from(b, c);
  const double sides = u[0] * u[0] + u[1] * u[1] + v[0] * v[0] + v[1] * v[1] + w[0] * w[0] + w[1] * w[1];
  return sides > 0 ? (u[0] * v[1] - u[1] * v[0]) / sides : 0;
}

template <class Point>
double least_area_from_above(std::span<const std::uint32_t> corners, const std::vector<Point>& points) {
  double least = 1;
  for (std::size_t c = 0; c < corners.size(); c += 3)
    least =
        std::min(least, area_from_above(points[corners[c]], points[corners[c + 1]], points[corners[c + 2]]));
  return least;
}

/// A flat surface whose faces all look up keeps that.
template <class Point>
void require_no_flips(const BasicDecimated<Point>& result, const Input<Point>& input) {
  constexpr double kClear = 1e-3, kRounding = 1e-5;
  for (const Point& p : input.points)
    if (p.z != input.points[0].z) return;
  if (!(least_area_from_above<Point>(input.corners, input.points) > kClear)) return;
  require(least_area_from_above<Point>(result.mesh.origins(), result.positions) > -kRounding,
          "no face is flipped");
}

template <class Point>
void require_sound(const BasicDecimated<Point>& result, const Input<Point>& input,
                   const DecimateOptions& options) {
  const auto valid = validate(result.mesh);
  require(valid.has_value(), "valid: " + (valid ? "" : valid.error().describe()));
  require(result.mesh.face_count() > 0, "something is left");
  require_maps(result, input, options);
  require_same_topology(result, input);
  require_locks(result, input, options);
  require_history(result, input);
  require_stop(result, input, options);
  require_no_flips(result, input);
}

template <class Point>
BasicDecimated<Point> run(const Input<Point>& input, const DecimateOptions& options) {
  auto result = decimate(input.mesh, std::span<const Point>(input.points), options);
  require(result.has_value(), "decimated: " + (result ? "" : result.error().describe()));
  require_sound(*result, input, options);
  return std::move(*result);
}

template <class Point>
bool same_operation(const Collapse<Point>& a, const Collapse<Point>& b) {
  return a.kept == b.kept && a.removed == b.removed && same_place(a.position, b.position) &&
         a.faces == b.faces;
}

template <class Point>
void fuzz_as(Bytes& bytes) {
  const RandomManifold made(bytes);
  Input<Point> input;
  using Scalar = typename Point::value_type;
  constexpr double kLargest = std::numeric_limits<Scalar>::max();
  for (const auto& p : made.points()) {
    for (const double x : p)
      if (!(std::fabs(x) <= kLargest)) return;  // decimation takes finite places only
    input.points.push_back({static_cast<Scalar>(p[0]), static_cast<Scalar>(p[1]), static_cast<Scalar>(p[2])});
  }
  input.corners = made.corners();
  input.topology = topology_of(input.points.size(), input.corners);
  IndexedFaceSet faces;
  faces.points.resize(input.points.size());
  faces.corners = input.corners;
  auto mesh = to_half_edge_mesh(faces);
  require(mesh.has_value(), "a random manifold is one");
  input.mesh = std::move(*mesh);
  input.used = input.topology.whole.points;

  DecimateOptions options = options_of(bytes, input);
  const std::uint8_t how = bytes.next();
  if (how % 4 == 1) options.target_faces = bytes.below(input.corners.size() / 3 + 1);
  const BasicDecimated<Point> whole = run(input, options);
  if (how % 4 != 0) return;
  // The same up to each vertex count: the state of the run after each of its operations.
  for (std::size_t left = input.used; left > whole.mesh.vertex_count(); --left) {
    options.target_vertices = left;
    const BasicDecimated<Point> part = run(input, options);
    require(part.history.size() <= whole.history.size() &&
                std::equal(part.history.begin(), part.history.end(), whole.history.begin(),
                           same_operation<Point>),
            "a target changes nothing before it is reached");
  }
}

void fuzz(std::span<const std::uint8_t> all) {
  Bytes bytes(all);
  if (bytes.next() % 2 == 0)
    fuzz_as<Vec3>(bytes);
  else
    fuzz_as<DVec3>(bytes);
}

}  // namespace
}  // namespace vkmesh::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vkmesh::fuzz::fuzz(std::span(data, size));
  return 0;
}
