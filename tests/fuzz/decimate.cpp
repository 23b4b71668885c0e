// Fuzzes decimate() over random manifolds: after every operation the surface is a manifold of the same
// topology, and whatever the result says of itself holds.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/analysis/topology.h>
#include <vkmesh/decimation/decimate.h>
#include <vkmesh/decimation/decimate_index_buffer.h>
#include <vkmesh/repair/consolidate.h>

#include "check.h"
#include "decimation/decimation_state.h"
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
  // What options borrow.
  std::vector<float> values;
  std::vector<std::uint32_t> value_of_corner, group_of_corner;
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

/// One attribute of few values, and groups of faces, or neither.
template <class Point>
void add_attributes(Bytes& bytes, Input<Point>& input, DecimateOptions& options) {
  const std::uint8_t how = bytes.next();
  if (how % 4 != 0) return;
  std::mt19937 random(bytes.next());
  const std::size_t corners = input.corners.size(), sides = 1 + how / 4 % 3;
  // Faces are on a side by where one of their corners is, so that seams are curves as well as dots.
  const auto side_of = [&](std::size_t face) {
    const auto corner = input.corners[3 * face + (how / 16 % 3)];
    return how % 16 == 0 ? random() % sides : corner * sides / input.points.size();
  };
  std::vector<std::size_t> side(corners / 3);
  for (std::size_t f = 0; f < side.size(); ++f) side[f] = side_of(f);
  if (how / 64 != 0) {
    DecimateAttribute attribute;
    attribute.components = 1 + how / 64 % 3;
    attribute.kind = attribute.components == 3 ? AttributeKind::kNormal : AttributeKind::kPlain;
    constexpr std::array<double, 4> kWeights = {0.01, 0, 1, 1e4};
    attribute.weight = kWeights[bytes.next() % 4];
    constexpr std::array<float, 4> kScales = {1, 0, 1e-30f, 1e15f};
    const float scale = attribute.components == 3 ? 1 : kScales[bytes.next() % 4];
    for (std::size_t i = 0; i < input.points.size() * sides; ++i) {
      const float a = static_cast<float>(random() % 5) * 0.25f;
      if (attribute.components == 3)
        input.values.insert(input.values.end(), {0.6f, a < 0.5f ? 0.0f : 0.8f, a < 0.5f ? 0.8f : 0.0f});
      else
        for (std::uint32_t k = 0; k < attribute.components; ++k)
          input.values.push_back(scale * (a + static_cast<float>(k)));
    }
    for (std::size_t c = 0; c < corners; ++c)
      input.value_of_corner.push_back(static_cast<std::uint32_t>(input.corners[c] * sides + side[c / 3]));
    attribute.values = input.values;
    attribute.corners = input.value_of_corner;
    options.attributes = {attribute};
  }
  if (how % 8 == 0) {
    for (std::size_t c = 0; c < corners; ++c)
      input.group_of_corner.push_back(static_cast<std::uint32_t>(side[c / 3]));
    options.corner_groups = input.group_of_corner;
  }
}

void add_criteria(Bytes& bytes, DecimateOptions& options) {
  const std::uint8_t which = bytes.next();
  if (which % 4 != 1) return;
  const double size = std::ldexp(1.0, bytes.next() % 16 - 12);
  DecimateBounds& bounds = options.bounds;
  if ((which & 4) != 0) bounds.distance = Length::relative(size);
  if ((which & 8) != 0) bounds.original_normal_deviation = std::min(0.1 + size, 3.0);
  if ((which & 16) != 0) bounds.aspect_ratio = 1 + size;
  if ((which & 32) != 0) bounds.edge_length = Length::absolute(size);
  if ((which & 64) != 0) bounds.valence = 3 + bytes.next() % 8;
  bounds.report_distance = (which & 128) != 0;
  const std::uint8_t weights = bytes.next();
  if ((weights & 1) != 0) options.weights.density = size;
  if ((weights & 2) != 0) options.weights.aspect_ratio = size;
  if ((weights & 4) != 0) options.weights.normals = size;
  if ((weights & 15) == 9) options.weights.quadric = 0;
}

template <class Point>
DecimateOptions options_of(Bytes& bytes, Input<Point>& input) {
  DecimateOptions options;
  options.keep_history = true;
  options.operation = std::array{DecimateOperation::kEdgeCollapse, DecimateOperation::kHalfEdgeCollapse,
                                 DecimateOperation::kVertexRemoval}[bytes.next() % 3];
  options.curves.boundary = std::array{DecimateBoundary::kInShape, DecimateBoundary::kFree,
                                       DecimateBoundary::kKept}[bytes.next() % 3];
  options.curves.boundary_weight = std::array{10.0, 0.0, 1e6, 1e-6}[bytes.next() % 4];
  options.bounds.normal_deviation = std::array{1.3, 1.3, 0.1, 3.14}[bytes.next() % 4];
  const std::uint8_t crease = bytes.next();
  if (crease % 4 == 0) options.curves.crease_angle = 0.01 + crease / 100.0;
  if (crease % 8 == 0) options.curves.crease_weight = 1e4;
  const std::uint8_t bound = bytes.next();
  if (bound % 4 == 1) options.bounds.error = Length::relative(bound / 4 / 640.0);
  if (bound % 4 == 2) options.bounds.error = Length::absolute(std::ldexp(1.0, bound / 4 - 32));
  const std::uint8_t prune = bytes.next();
  if (prune % 8 == 1) options.prune_size = Length::relative(prune / 256.0);
  options.locked.vertices = some_of(bytes, input.points.size());
  options.locked.edges = some_of(bytes, input.corners.size());
  options.locked.faces = some_of(bytes, input.corners.size() / 3);
  add_attributes(bytes, input, options);
  add_criteria(bytes, options);
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
    if (options.prune_size) continue;
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
  if (options.prune_size) return;  // what is locked may be pruned
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
  for (const std::uint32_t v : options.locked.vertices) require_vertex(v);
  for (const std::uint32_t h : options.locked.edges) require_edge(h);
  for (const std::uint32_t f : options.locked.faces)
    for (std::uint32_t i = 0; i < 3; ++i) require_edge(3 * f + i);
  if (options.curves.boundary != DecimateBoundary::kKept) return;
  for (std::uint32_t h = 0; h < input.corners.size(); ++h)
    if (input.mesh.is_boundary(HalfEdgeId(h))) require_edge(h);
  require(result.mesh.boundary_half_edge_count() == input.mesh.boundary_half_edge_count(),
          "a boundary that is kept stays");
}

/// How many parts the seams cut a surface into; `alike` tells whether two corners at one vertex agree.
template <class Alike>
std::size_t charts(const HalfEdgeMesh& mesh, Alike&& alike) {
  std::vector<std::uint32_t> part(mesh.face_count());
  std::iota(part.begin(), part.end(), 0u);
  const auto root = [&](std::uint32_t f) {
    while (part[f] != f) f = part[f];
    return f;
  };
  std::size_t count = part.size();
  mesh.for_each_edge([&](HalfEdgeId h) {
    if (mesh.is_boundary(h)) return;
    const HalfEdgeId t = mesh.twin(h);
    const bool seam = !alike(h.index, mesh.next(t).index) || !alike(mesh.next(h).index, t.index);
    const std::uint32_t a = root(mesh.face(h).index), b = root(mesh.face(t).index);
    if (seam || a == b) return;
    part[a] = b;
    --count;
  });
  return count;
}

template <class Point>
void require_attributes(const BasicDecimated<Point>& result, const Input<Point>& input,
                        const DecimateOptions& options) {
  const DecimatedAttributes& after = result.attributes;
  const bool any = !options.attributes.empty() || !options.corner_groups.empty();
  require(after.corners.size() == (any ? result.mesh.half_edge_count() : 0), "each corner has a wedge");
  require(std::isfinite(result.attribute_error) && result.attribute_error >= 0,
          "the attribute error is a number");
  if (!any) return;
  std::uint32_t wedges = 0;
  for (const std::uint32_t w : after.corners) {
    require(w <= wedges, "wedges are numbered as they come");
    wedges = std::max(wedges, w + 1);
  }
  require(after.source_corner.size() == wedges && after.values.size() == options.attributes.size(),
          "wedges have sources and values");
  const auto alike = [&](std::uint32_t a, std::uint32_t b) {
    const std::size_t n = options.attributes.empty() ? 0 : options.attributes[0].components;
    for (std::size_t k = 0; k < n; ++k)
      if (input.values[n * input.value_of_corner[a] + k] != input.values[n * input.value_of_corner[b] + k])
        return false;
    return input.group_of_corner.empty() || input.group_of_corner[a] == input.group_of_corner[b];
  };
  if (!options.prune_size)
    require(charts(input.mesh, alike) ==
                charts(result.mesh, [&](std::uint32_t a,
                                        std::uint32_t b) { return after.corners[a] == after.corners[b]; }),
            "seams cut out the same number of charts");
  const auto unmoved = [&](std::uint32_t v) {
    return same_place(result.positions[v], input.points[result.source_vertex[v]]);
  };
  for (std::uint32_t c = 0; c < after.corners.size(); ++c) {
    const std::uint32_t from = after.source_corner[after.corners[c]], v = result.mesh.origins()[c];
    require(from < input.corners.size() && result.vertex_map[input.corners[from]] == v,
            "wedges come from corners of their vertex");
    if (options.attributes.empty()) continue;
    const std::size_t n = options.attributes[0].components;
    require(after.values[0].size() == n * wedges, "wedges have values");
    for (std::size_t k = 0; k < n; ++k) {
      const float value = after.values[0][n * after.corners[c] + k];
      require(std::isfinite(value), "values are finite");
      if (options.operation != DecimateOperation::kEdgeCollapse && unmoved(v))
        require(value == input.values[n * input.value_of_corner[from] + k], "values are kept");
    }
  }
}

/// The history, done again, gives the same corners, with the same values.
template <class Point>
void require_changes(const BasicDecimated<Point>& result, const Input<Point>& input,
                     const DecimateOptions& options) {
  const DecimationChanges& changes = result.changes;
  const bool any = !options.attributes.empty() || !options.corner_groups.empty();
  require(changes.corners.size() == (any ? input.corners.size() : 0), "each corner has a wedge at first");
  std::vector<std::uint32_t> corners = input.corners, wedges = changes.corners;
  std::vector<bool> there(corners.size() / 3, true);
  const std::size_t n = options.attributes.empty() ? 0 : options.attributes[0].components;
  std::map<std::uint32_t, std::size_t> changed;  // by wedge where its values are now
  auto face = changes.faces.begin();
  auto wedge = changes.wedges.begin();
  for (std::uint32_t step = 0; step < result.history.size(); ++step) {
    const Collapse<Point>& c = result.history[step];
    for (const std::uint32_t f : c.faces)
      if (f != kInvalid) there[f] = false;
    std::replace(corners.begin(), corners.end(), c.removed, c.kept);
    for (; wedge != changes.wedges.end() && wedge->step == step; ++wedge) {
      std::replace(wedges.begin(), wedges.end(), wedge->wedge, wedge->into);
      changed[wedge->into] = static_cast<std::size_t>(wedge - changes.wedges.begin());
    }
    for (; face != changes.faces.end() && face->step == step; ++face) {
      require(there[face->face], "faces that change are there");
      std::copy(face->vertices.begin(), face->vertices.end(), corners.begin() + 3 * face->face);
      if (any) std::copy(face->wedges.begin(), face->wedges.end(), wedges.begin() + 3 * face->face);
    }
  }
  require(face == changes.faces.end() && wedge == changes.wedges.end(), "changes are in order");
  for (std::size_t f = 0; f < result.mesh.face_count(); ++f) {
    const std::size_t from = result.source_face[f];
    require(there[from], "the history and the faces agree");
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t v = result.mesh.origins()[3 * f + i];
      require(corners[3 * from + i] == result.source_vertex[v], "the history and the corners agree");
      if (!any) continue;
      const std::uint32_t w = result.attributes.corners[3 * f + i], was = wedges[3 * from + i];
      require(result.attributes.source_corner[w] == was, "the history and the wedges agree");
      const auto at = changed.find(was);
      for (std::size_t k = 0; k < n; ++k)
        require(result.attributes.values[0][n * w + k] ==
                    (at != changed.end() ? changes.values[0][n * at->second + k]
                                         : input.values[n * input.value_of_corner[was] + k]),
                "the history and the values agree");
    }
  }
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
  const std::size_t most_faces = options.target.faces.value_or(0),
                    most_vertices = options.target.vertices.value_or(0);
  const bool reached = faces <= most_faces || vertices <= most_vertices;
  require(reached == (result.stop == DecimateStop::kTargetReached), "it says whether a target was reached");
  if (result.collapses > 0)
    require(faces + 1 >= most_faces && vertices >= most_vertices, "no target is undershot");
  require(std::isfinite(result.error) && result.error >= 0, "the error is a number");
  constexpr double kRounding = 1 + 1e-6;
  if (const auto& bound = options.bounds.error)
    require((bound->is_relative ? result.relative_error : result.error) <= kRounding * bound->value,
            "the bound of the error holds");
  if (!options.prune_size)
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

/// What is told of the distance between both surfaces, and of what blocks the rest.
template <class Point>
void require_criteria(const BasicDecimated<Point>& result, const Input<Point>& input,
                      const DecimateOptions& options) {
  const DecimateBounds& bounds = options.bounds;
  require(result.distance_bound.has_value() == (bounds.report_distance || bounds.distance),
          "the distance is told when it is watched");
  const auto& counts = result.blocked.counts;
  const std::size_t blocked = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  const std::size_t left = options.operation == DecimateOperation::kVertexRemoval ? result.mesh.vertex_count()
                                                                                  : result.mesh.edge_count();
  if (result.stop == DecimateStop::kTargetReached)
    require(blocked == 0, "nothing blocks what could go on");
  else if (result.stop == DecimateStop::kOutOfProportion)
    require(blocked <= left, "no more is blocked than is left");  // some of it could go
  else if (result.stop != DecimateStop::kTimeLimit)
    require(blocked == left, "something blocks all that is left");
  if constexpr (std::is_same_v<Point, Vec3>) {
    if (!result.distance_bound || options.prune_size || result.mesh.face_count() > 500) return;
    const auto distance = surface_distance({input.points, input.corners},
                                           {result.positions, result.mesh.origins()}, {300, 1, 0});
    if (!distance) return;  // no area
    require(distance->two_sided().maximum <= *result.distance_bound + 1e-6 * distance->diagonal,
            "no sample is farther than the bound");
    if (bounds.distance)
      require(*result.distance_bound <= bounds.distance->in_units(distance->diagonal) * (1 + 1e-6),
              "the bound holds");
  }
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
  if (options.keep_history) {
    require_history(result, input);
    require_changes(result, input, options);
  }
  require_stop(result, input, options);
  require_no_flips(result, input);
  require_attributes(result, input, options);
  require_criteria(result, input, options);
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
  if (how % 4 == 1) options.target.faces = bytes.below(input.corners.size() / 3 + 1);
  const BasicDecimated<Point> whole = run(input, options);
  if constexpr (std::is_same_v<Point, Vec3>) {
    const auto parted = detail::decimate_in_partitions({input.points, input.corners}, options);
    require(parted.has_value(), "decimated in parts");
    require_sound(*parted, input, options);
    // Swept at first if the target is far.
    DecimateOptions free = options;
    free.keep_history = false;
    free.bounds.error.reset();
    const auto swept = detail::decimate_in_partitions({input.points, input.corners}, free);
    require(swept.has_value(), "swept");
    require_sound(*swept, input, free);
    if (options.operation == DecimateOperation::kHalfEdgeCollapse && options.attributes.empty() &&
        options.corner_groups.empty())
      fuzz_index_buffer(input, options);
  }
  if (how % 4 != 0) return;
  // The same up to each vertex count: the state of the run after each of its operations.
  for (std::size_t left = input.used; left > whole.mesh.vertex_count(); --left) {
    options.target.vertices = left;
    const BasicDecimated<Point> part = run(input, options);
    require(part.history.size() <= whole.history.size() &&
                std::equal(part.history.begin(), part.history.end(), whole.history.begin(),
                           same_operation<Point>),
            "a target changes nothing before it is reached");
  }
}

/// The surface of an index buffer when points at the same place are one.
Topology welded(const std::vector<Vec3>& points, std::span<const std::uint32_t> indices) {
  std::map<std::array<float, 3>, std::uint32_t> first;
  std::vector<std::uint32_t> corners;
  for (const std::uint32_t i : indices) {
    const Vec3& p = points[i];
    corners.push_back(first.try_emplace({p.x, p.y, p.z}, i).first->second);
  }
  return topology_of(points.size(), corners).whole;
}

/// The same as an index buffer, whose points may coincide.
void fuzz_index_buffer(const Input<Vec3>& input, DecimateOptions options) {
  options.keep_history = false;
  const Topology before = welded(input.points, input.corners);
  const auto result = decimate_index_buffer(input.points, input.corners, options);
  require(result.has_value(), "any triangles are taken");
  require(result->indices.size() == 3 * result->source_face.size(), "each triangle has a source");
  for (const std::uint32_t i : result->indices) require(i < input.points.size(), "indices name vertices");
  require(std::is_sorted(result->source_face.begin(), result->source_face.end(), std::less_equal<>()),
          "sources ascend");
  if (!before.manifold() || !before.oriented()) return;
  const Topology after = welded(input.points, result->indices);
  require(after.manifold() && after.oriented(), "a level is a manifold");
  if (options.prune_size) return;
  require(after.euler_characteristic() == before.euler_characteristic() &&
              after.boundary_loops == before.boundary_loops,
          "a level has the topology of the first");
  require((after.faces > 0) == (before.faces > 0), "something is left");
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
