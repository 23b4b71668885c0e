#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/decimation/decimate_index_buffer.h>
#include <vkmesh/repair/consolidate.h>

#include "decimation/decimate_support.h"
#include "decimation/decimation_state.h"
#include "support/data.h"
#include "support/shapes.h"
#include "support/vectors.h"

namespace vkmesh {
namespace {

using test::cross, test::dot;
using test::half_edges, test::run, test::ways;

/// A mesh with one attribute, whose values its corners name.
struct Textured {
  IndexedFaceSet mesh;
  std::uint32_t components = 2;
  std::vector<float> values;
  std::vector<std::uint32_t> corners;

  [[nodiscard]] DecimateAttribute attribute(double weight) const {
    return {components, values, corners, weight, AttributeKind::kPlain};
  }
};

std::vector<std::uint32_t> corners_of(const Decimated& d) {
  return {d.mesh.origins().begin(), d.mesh.origins().end()};
}

class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }
  void unite(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

/// The seams of triangles whose corners have an id each: edges whose two sides differ at one of their ends.
struct Seams {
  std::map<std::uint32_t, std::size_t> degree;  // of the vertices on seams
  std::size_t edges = 0, components = 0, charts = 0;

  Seams(const std::vector<std::uint32_t>& corners, const std::vector<std::uint32_t>& ids) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> from;
    const auto next = [](std::size_t c) { return c % 3 == 2 ? c - 2 : c + 1; };
    for (std::size_t c = 0; c < corners.size(); ++c) from[{corners[c], corners[next(c)]}] = c;
    Sets faces(corners.size() / 3), vertices(*std::max_element(corners.begin(), corners.end()) + 1);
    for (const auto& [ends, c] : from) {
      const auto twin = from.find({ends.second, ends.first});
      if (ends.first > ends.second || twin == from.end()) continue;
      const std::size_t t = twin->second;
      if (ids[c] == ids[next(t)] && ids[next(c)] == ids[t]) {
        faces.unite(static_cast<std::uint32_t>(c / 3), static_cast<std::uint32_t>(t / 3));
        continue;
      }
      ++edges;
      ++degree[ends.first];
      ++degree[ends.second];
      vertices.unite(ends.first, ends.second);
    }
    std::set<std::uint32_t> roots;
    for (const auto& [v, d] : degree) roots.insert(vertices.find(v));
    components = roots.size();
    roots.clear();
    for (std::uint32_t f = 0; f < corners.size() / 3; ++f) roots.insert(faces.find(f));
    charts = roots.size();
  }

  /// Loops of the graph that the seams form: edges - vertices + components.
  [[nodiscard]] std::size_t loops() const { return edges + components - degree.size(); }
  [[nodiscard]] std::size_t of_degree(std::size_t d) const {
    return static_cast<std::size_t>(
        std::count_if(degree.begin(), degree.end(), [&](const auto& v) { return v.second == d; }));
  }
};

/// What holds of every result: the same charts, seams that form the same curves, values in range.
void check_seams(const Textured& input, const Decimated& result) {
  const Seams before(input.mesh.corners, input.corners), after(corners_of(result), result.attributes.corners);
  CHECK(after.charts == before.charts);
  CHECK(after.components == before.components);
  CHECK(after.loops() == before.loops());
  for (const std::size_t d : {1U, 3U, 4U, 5U}) CHECK(after.of_degree(d) == before.of_degree(d));
  REQUIRE(result.attributes.values.size() == 1);
  const std::vector<float>& values = result.attributes.values[0];
  REQUIRE(values.size() == input.components * result.attributes.source_corner.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    float low = input.values[i % input.components], high = low;
    for (std::size_t j = i % input.components; j < input.values.size(); j += input.components) {
      low = std::min(low, input.values[j]);
      high = std::max(high, input.values[j]);
    }
    CHECK((values[i] >= low && values[i] <= high));
  }
  // Wedges are numbered as they come, and each belongs to one vertex.
  std::map<std::uint32_t, std::uint32_t> vertex_of;
  std::uint32_t next = 0;
  for (std::size_t c = 0; c < result.attributes.corners.size(); ++c) {
    const std::uint32_t w = result.attributes.corners[c], v = result.mesh.origins()[c];
    REQUIRE(w <= next);
    next = std::max(next, w + 1);
    CHECK(vertex_of.try_emplace(w, v).first->second == v);
  }
  CHECK(next == result.attributes.source_corner.size());
}

/// A tube round the z axis, u once round from a seam at y = 0, v along it.
Textured unrolled_cylinder(std::uint32_t rings, std::uint32_t sides) {
  Textured t;
  t.mesh = test::cylinder(rings, sides);
  for (std::uint32_t i = 0; i <= rings; ++i)
    for (std::uint32_t j = 0; j <= sides; ++j) {
      t.values.push_back(static_cast<float>(j) / static_cast<float>(sides));
      t.values.push_back(static_cast<float>(i) / static_cast<float>(rings));
    }
  for (std::size_t f = 0; f < t.mesh.face_count(); ++f) {
    const auto face = t.mesh.face(f);
    const bool last = std::any_of(face.begin(), face.end(), [&](auto v) { return v % sides == sides - 1; });
    for (const std::uint32_t v : face)
      t.corners.push_back(v / sides * (sides + 1) + (last && v % sides == 0 ? sides : v % sides));
  }
  return t;
}

/// Each octant of a sphere is a chart with values of its own.
Textured sphere_of_octants(unsigned level) {
  Textured t;
  t.mesh = test::icosphere(level);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> value;
  for (std::size_t f = 0; f < t.mesh.face_count(); ++f) {
    const auto face = t.mesh.face(f);
    const Vec3 middle = t.mesh.points[face[0]] + t.mesh.points[face[1]] + t.mesh.points[face[2]];
    const std::uint32_t octant =
        (middle.x > 0 ? 1u : 0u) + (middle.y > 0 ? 2u : 0u) + (middle.z > 0 ? 4u : 0u);
    for (const std::uint32_t v : face) {
      const auto [place, is_new] =
          value.try_emplace({v, octant}, static_cast<std::uint32_t>(t.values.size() / 2));
      if (is_new) {
        t.values.push_back(t.mesh.points[v].x * t.mesh.points[v].y + static_cast<float>(octant));
        t.values.push_back(t.mesh.points[v].z);
      }
      t.corners.push_back(place->second);
    }
  }
  return t;
}

TEST_CASE("Decimation of a plane with a linear attribute loses nothing", "[decimate]") {
  const IndexedFaceSet mesh = test::grid(20, 15);
  std::vector<float> uv;
  for (const Vec3& p : mesh.points) uv.insert(uv.end(), {p.x / 20, p.y / 20 - 3});
  DecimateOptions options;
  options.bounds.error = Length::absolute(1e-4);
  options.attributes = {{2, uv, {}, 1.0, AttributeKind::kPlain}};
  for (const DecimateOperation operation :
       {DecimateOperation::kEdgeCollapse, DecimateOperation::kHalfEdgeCollapse,
        DecimateOperation::kVertexRemoval}) {
    CAPTURE(static_cast<int>(operation));
    options.operation = operation;
    const Decimated d = run(mesh, options);
    CHECK(d.mesh.face_count() == 2);
    CHECK(d.error < 1e-6);
    CHECK(d.attribute_error < 1e-6);
    REQUIRE(d.attributes.source_corner.size() == 4);
    for (std::size_t c = 0; c < d.mesh.half_edge_count(); ++c) {
      const Vec3 p = d.positions[d.mesh.origins()[c]];
      const float* const value = &d.attributes.values[0][2 * d.attributes.corners[c]];
      CHECK(std::fabs(value[0] - p.x / 20) < 2e-6f);
      CHECK(std::fabs(value[1] - (p.y / 20 - 3)) < 2e-6f);
    }
  }
}

TEST_CASE("the bound of the error is of the surface alone", "[decimate]") {
  const IndexedFaceSet mesh = test::grid(20, 15);
  std::vector<float> values;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) values.push_back(static_cast<float>(v * v % 17));
  DecimateOptions options = ways()[1];  // no point leaves the plane, nor the boundary its line
  options.bounds.error = Length::absolute(1e-4);
  options.attributes = {{1, values, {}, 1.0, AttributeKind::kPlain}};
  const Decimated d = run(mesh, options);
  CHECK(d.mesh.face_count() < 30);
  CHECK(d.error < 1e-4);
  CHECK(d.attribute_error > 0.01);
}

/// Root of the mean squared difference between an attribute over a plane mesh and f(x, y).
template <class F>
double deviation_from(const Decimated& d, int size, F&& f) {
  // Each face asks the points of a grid that lie in its box; one on an edge goes to the first face.
  const std::size_t side = 4 * static_cast<std::size_t>(size);
  std::vector<bool> seen(side * side, false);
  double sum = 0;
  int found = 0;
  for (std::size_t face = 0; face < d.mesh.face_count(); ++face) {
    std::array<DVec3, 3> p;
    std::array<double, 3> value{};
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = DVec3(d.positions[d.mesh.origins()[3 * face + k]]);
      value[k] = d.attributes.values[0][d.attributes.corners[3 * face + k]];
    }
    const auto range = [&](int axis) {
      const auto [low, high] = std::minmax({p[0][axis], p[1][axis], p[2][axis]});
      const auto at = [&](double x) {
        return static_cast<std::size_t>(std::clamp(4 * x, 0.0, static_cast<double>(side)));
      };
      return std::pair(at(low - 0.25), std::min(at(high) + 1, side));
    };
    const auto [left, right] = range(0);
    const auto [bottom, top] = range(1);
    for (std::size_t j = bottom; j < top; ++j)
      for (std::size_t i = left; i < right; ++i) {
        if (seen[j * side + i]) continue;
        const double x = (static_cast<double>(i) + 0.37) / 4, y = (static_cast<double>(j) + 0.59) / 4;
        const auto area = [&](const DVec3& a, const DVec3& b) {
          return (a.x - x) * (b.y - y) - (a.y - y) * (b.x - x);
        };
        const double a = area(p[1], p[2]), b = area(p[2], p[0]), c = area(p[0], p[1]);
        if (a < 0 || b < 0 || c < 0 || !(a + b + c > 0)) continue;
        const double off = (a * value[0] + b * value[1] + c * value[2]) / (a + b + c) - f(x, y);
        sum += off * off;
        ++found;
        seen[j * side + i] = true;
      }
  }
  REQUIRE(found > 15 * size * size);
  return std::sqrt(sum / found);
}

TEST_CASE("Triangles go where an attribute is curved", "[decimate]") {
  constexpr int kSize = 40;
  const IndexedFaceSet mesh = test::grid(kSize, kSize);
  const auto colour = [](double x, double y) {
    return x < 20 ? 0.0 : (x - 20) * (x - 20) * (2 + std::cos(y / 8)) / 1200;
  };
  const auto step = [](double x, double y) { return x + 0.5 * y < 30 ? 0.0 : 1.0; };
  const auto both = [&](auto&& f, DecimateOperation operation) {
    std::vector<float> values;
    for (const Vec3& p : mesh.points) values.push_back(static_cast<float>(f(p.x, p.y)));
    DecimateOptions options;
    options.operation = operation;
    options.target.faces = 120;
    options.attributes = {{1, values, {}, 0.0, AttributeKind::kPlain}};
    const Decimated without = run(mesh, options);
    options.attributes[0].weight = 0.1;
    const Decimated with = run(mesh, options);
    CHECK(with.mesh.face_count() <= 120);
    CHECK(with.attribute_error > 0);
    const double error = deviation_from(with, kSize, f), other = deviation_from(without, kSize, f);
    CAPTURE(error, other);
    CHECK(error < 0.5 * other);
    return with;
  };
  const Decimated curved = both(colour, DecimateOperation::kEdgeCollapse);
  both(step, DecimateOperation::kEdgeCollapse);
  both(colour, DecimateOperation::kVertexRemoval);
  both(step, DecimateOperation::kVertexRemoval);
  std::size_t flat = 0;
  for (std::size_t face = 0; face < curved.mesh.face_count(); ++face) {
    float x = 0;
    for (std::size_t k = 0; k < 3; ++k) x += curved.positions[curved.mesh.origins()[3 * face + k]].x / 3;
    flat += x < 20 ? 1 : 0;
  }
  CHECK(flat < curved.mesh.face_count() / 5);  // of half the plane
}

TEST_CASE("A seam of a tube stays closed and straight", "[decimate]") {
  const Textured tube = unrolled_cylinder(40, 48);
  for (DecimateOptions options : ways()) {
    options.target.ratio = 0.1;
    options.attributes = {tube.attribute(0.01)};
    const Decimated d = run(tube.mesh, options);
    CHECK(d.stop == DecimateStop::kTargetReached);
    check_seams(tube, d);
    const Seams seams(corners_of(d), d.attributes.corners);
    CHECK(seams.edges < 40);
    for (const auto& [v, degree] : seams.degree) {
      CHECK(degree == (d.positions[v].z == 0 || d.positions[v].z == 40 ? 1 : 2));
      CHECK(std::hypot(d.positions[v].x - 1, d.positions[v].y) < 1e-4f);
      std::set<float> u;
      for (std::size_t c = 0; c < d.mesh.half_edge_count(); ++c)
        if (d.mesh.origins()[c] == v) u.insert(d.attributes.values[0][2 * d.attributes.corners[c]]);
      REQUIRE(u.size() == 2);
      CHECK(*u.begin() < 1e-4f);
      CHECK(*u.rbegin() > 1 - 1e-4f);
    }
    for (std::size_t c = 0; c < d.mesh.half_edge_count(); ++c) {
      const float v = d.attributes.values[0][2 * d.attributes.corners[c] + 1];
      CHECK(std::fabs(v - d.positions[d.mesh.origins()[c]].z / 40) < 0.005f);
    }
  }
}

TEST_CASE("Charts keep their seams whatever is left of them", "[decimate]") {
  const Textured sphere = sphere_of_octants(3);
  const Seams before(sphere.mesh.corners, sphere.corners);
  REQUIRE(before.charts == 8);
  REQUIRE(before.of_degree(2) > 0);
  std::set<std::array<float, 3>> junctions;
  for (const auto& [v, degree] : before.degree)
    if (degree != 2) {
      const Vec3 p = sphere.mesh.points[v];
      junctions.insert({p.x, p.y, p.z});
    }
  REQUIRE(junctions.size() >= 6);
  std::size_t rejected = 0;
  for (DecimateOptions options : ways())
    for (const double ratio : {0.3, 0.0}) {
      CAPTURE(ratio);
      options.target.ratio = ratio;
      options.bounds.normal_deviation = 3.0;
      options.attributes = {sphere.attribute(0.01)};
      const Decimated d = run(sphere.mesh, options);
      check_seams(sphere, d);
      rejected += d.rejected[Reason::kSeam];
      std::size_t kept = 0;
      for (const Vec3& p : d.positions) kept += junctions.count({p.x, p.y, p.z});
      CHECK(kept == junctions.size());
      // The same bytes again.
      const Decimated again = run(sphere.mesh, options);
      CHECK(again.positions == d.positions);
      CHECK(again.attributes.values == d.attributes.values);
      CHECK(again.attributes.corners == d.attributes.corners);
    }
  CHECK(rejected > 0);
}

/// For each face the chart, those about random points.
std::vector<std::uint32_t> random_charts(const IndexedFaceSet& mesh, std::size_t charts,
                                         std::mt19937& random) {
  std::vector<Vec3> middle;
  for (std::size_t i = 0; i < charts; ++i) middle.push_back(mesh.points[random() % mesh.points.size()]);
  std::vector<std::uint32_t> chart;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    const Vec3 p = mesh.points[face[0]] + mesh.points[face[1]] + mesh.points[face[2]];
    const auto distance = [&](const Vec3& q) {
      const Vec3 d = p - 3.0f * q;
      return d.x * d.x + d.y * d.y + d.z * d.z;
    };
    const auto nearest = std::min_element(middle.begin(), middle.end(), [&](const Vec3& a, const Vec3& b) {
      return distance(a) < distance(b);
    });
    chart.push_back(static_cast<std::uint32_t>(nearest - middle.begin()));
  }
  return chart;
}

TEST_CASE("Any charts stay, whatever order collapses come in", "[decimate]") {
  // Nothing has a cost in a plane: only the rules hold the seams.
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    std::mt19937 random(seed);
    Textured t;
    t.mesh = seed % 3 == 0 ? test::icosphere(3) : test::grid(18, 15);
    t.components = 1;
    const std::size_t charts = 2 + seed;
    for (const std::uint32_t chart : random_charts(t.mesh, charts, random))
      t.corners.insert(t.corners.end(), 3, chart);
    for (std::size_t i = 0; i < charts; ++i) t.values.push_back(static_cast<float>(i));
    for (DecimateOptions options : ways()) {
      CAPTURE(seed, static_cast<int>(options.operation));
      options.target.faces = 0;
      options.bounds.normal_deviation = 3.1;
      options.curves.seam_weight = options.curves.boundary_weight = 0;
      options.attributes = {t.attribute(0.0)};
      for (int i = 0; i < 20; ++i)
        options.locked.vertices.push_back(static_cast<std::uint32_t>(random() % t.mesh.points.size()));
      const Decimated d = run(t.mesh, options);
      check_seams(t, d);
      CHECK(d.mesh.face_count() < t.mesh.face_count() / 2);
      // Each chart has its own value, in the result as well.
      for (std::size_t c = 0; c < d.mesh.half_edge_count(); ++c)
        CHECK(std::fabs(d.attributes.values[0][d.attributes.corners[c]] -
                        static_cast<float>(t.corners[3 * d.source_face[c / 3]])) < 4e-6f);
    }
  }
}

/// Charts with values of their own at each vertex.
Textured with_random_charts(IndexedFaceSet mesh, std::uint32_t seed) {
  std::mt19937 random(seed);
  Textured t;
  t.mesh = std::move(mesh);
  const std::vector<std::uint32_t> chart = random_charts(t.mesh, 2 + seed % 4, random);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> value;
  for (std::size_t c = 0; c < t.mesh.corners.size(); ++c) {
    const auto next = static_cast<std::uint32_t>(t.values.size() / 2);
    const auto [place, is_new] = value.try_emplace({t.mesh.corners[c], chart[c / 3]}, next);
    if (is_new) {
      const Vec3 p = t.mesh.points[t.mesh.corners[c]];
      t.values.insert(t.values.end(), {p.x * p.y + static_cast<float>(chart[c / 3]), p.z});
    }
    t.corners.push_back(place->second);
  }
  return t;
}

TEST_CASE("Each removal of a vertex takes at most one of a seam, whose neighbours there it joins",
          "[decimate]") {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::size_t on_seams = 0, elsewhere = 0;
  for (std::uint32_t seed = 1; seed < (test::kSanitized ? 2u : 13u); ++seed) {
    IndexedFaceSet shape = seed % 3 == 0   ? test::icosphere(2)
                           : seed % 3 == 1 ? test::grid(10, 9)
                                           : test::torus(12, 9);
    test::jitter(shape, 0.02f, seed);
    const Textured t = with_random_charts(shape, seed);
    DecimateOptions options = ways()[2];
    options.bounds.normal_deviation = 2.0;
    options.attributes = {t.attribute(0.1)};
    std::set<Edge> before;
    std::set<std::uint32_t> left_before;
    for (std::size_t left = t.mesh.points.size();; --left) {
      options.target.vertices = left;
      const Decimated d = run(t.mesh, options);
      if (d.mesh.vertex_count() > left) break;
      const auto& after = d.attributes.corners;
      const std::span<const std::uint32_t> of = d.mesh.origins();
      std::set<Edge> seams;
      d.mesh.for_each_edge([&](HalfEdgeId h) {
        if (d.mesh.is_boundary(h)) return;
        const std::uint32_t g = h.index, u = d.mesh.twin(h).index;
        const std::uint32_t to_g = d.mesh.next(h).index, to_u = d.mesh.next(HalfEdgeId(u)).index;
        if (after[g] == after[to_u] && after[to_g] == after[u]) return;
        seams.insert(std::minmax(d.source_vertex[of[g]], d.source_vertex[of[to_g]]));
      });
      const std::set<std::uint32_t> still(d.source_vertex.begin(), d.source_vertex.end());
      if (!left_before.empty()) {
        std::vector<std::uint32_t> gone;
        std::set_difference(left_before.begin(), left_before.end(), still.begin(), still.end(),
                            std::back_inserter(gone));
        REQUIRE(gone.size() == 1);
        std::vector<std::uint32_t> joined;
        std::set<Edge> expected;
        for (const Edge& e : before) {
          if (e.first == gone[0] || e.second == gone[0])
            joined.push_back(e.first == gone[0] ? e.second : e.first);
          else
            expected.insert(e);
        }
        if (!joined.empty()) {
          REQUIRE(joined.size() == 2);
          CHECK(expected.insert(std::minmax(joined[0], joined[1])).second);
        }
        ++(joined.empty() ? elsewhere : on_seams);
        CHECK(seams == expected);
      }
      before = std::move(seams);
      left_before = still;
      // Every corner has the value of its vertex on its own side, bit by bit.
      std::size_t wrong = 0;
      for (std::size_t c = 0; c < of.size(); ++c) {
        const std::uint32_t source = d.attributes.source_corner[after[c]], value = t.corners[source];
        wrong += t.mesh.corners[source] == d.source_vertex[of[c]] ? 0 : 1;
        for (std::size_t k = 0; k < 2; ++k)
          wrong += d.attributes.values[0][2 * after[c] + k] == t.values[2 * value + k] ? 0 : 1;
        const auto chart = [&](std::uint32_t corner) {
          const Vec3 p = t.mesh.points[t.mesh.corners[corner]];
          return std::lround(t.values[2 * t.corners[corner]] - p.x * p.y);
        };
        wrong += chart(source) == chart(3 * d.source_face[c / 3]) ? 0 : 1;
      }
      CHECK(wrong == 0);
    }
    CHECK(left_before.size() < t.mesh.points.size() / 2);
  }
  CHECK(on_seams > (test::kSanitized ? 5u : 50u));
  CHECK(elsewhere > (test::kSanitized ? 20u : 400u));
}

TEST_CASE("A chart of one face at the boundary is not cut off", "[decimate]") {
  IndexedFaceSet mesh = test::grid(1, 1);
  const Decimated alone = run(mesh, ways()[2]);
  CHECK(alone.mesh.face_count() == 1);
  DecimateOptions options = ways()[2];
  const std::vector<std::uint32_t> groups = {0, 0, 0, 1, 1, 1};
  options.corner_groups = groups;
  const Decimated split = run(mesh, options);
  CHECK(split.mesh.face_count() == 2);
  CHECK(split.blocked[Reason::kSeam] == 4);  // two of them are where the seam reaches the boundary
}

TEST_CASE("Vertices go by criteria, too, with attributes", "[decimate]") {
  for (const std::uint32_t seed : {3u, 4u, 5u}) {
    if (test::kSanitized && seed != 4) continue;
    IndexedFaceSet mesh = seed == 4 ? test::grid(24, 20) : test::icosphere(3);
    test::jitter(mesh, 0.01f, seed);
    const Textured t = with_random_charts(std::move(mesh), seed);
    DecimateOptions options = ways()[2];
    options.target.ratio = 0.2;
    options.attributes = {t.attribute(0.05)};
    const Decimated fast = run(t.mesh, options);
    check_seams(t, fast);
    options.weights.density = 1e-8;  // takes the heap, and counts next to nothing
    const Decimated exact = run(t.mesh, options);
    check_seams(t, exact);
    CHECK(exact.stop == DecimateStop::kTargetReached);
    CHECK(fast.attribute_error < 2 * exact.attribute_error);
    options.weights.aspect_ratio = 0.1;
    options.bounds.distance = Length::relative(0.05);
    options.bounds.valence = 9;
    const Decimated by_criteria = run(t.mesh, options);
    check_seams(t, by_criteria);
    CHECK(by_criteria.collapses > t.mesh.points.size() / 4);
  }
}

TEST_CASE("A slit stays open, be it of one point", "[decimate]") {
  Textured t;
  t.mesh = test::grid(12, 12);
  t.components = 1;
  for (const float above : {0.0f, 1.0f}) t.values.insert(t.values.end(), t.mesh.points.size(), above);
  for (std::size_t f = 0; f < t.mesh.face_count(); ++f) {
    const auto face = t.mesh.face(f);
    const bool above = std::any_of(face.begin(), face.end(), [&](auto v) { return t.mesh.points[v].y > 6; });
    for (const std::uint32_t v : face) {
      const bool on_slit = t.mesh.points[v].y == 6 && t.mesh.points[v].x > 4 && t.mesh.points[v].x < 8;
      t.corners.push_back(on_slit && above ? v + static_cast<std::uint32_t>(t.mesh.points.size()) : v);
    }
  }
  for (DecimateOptions options : ways()) {
    options.target.faces = 0;
    options.bounds.normal_deviation = 3.0;
    options.curves.seam_weight = options.curves.boundary_weight = 0;
    options.attributes = {t.attribute(0.0)};
    const Decimated d = run(t.mesh, options);
    check_seams(t, d);
    CHECK(Seams(corners_of(d), d.attributes.corners).edges == 2);
  }
}

TEST_CASE("A locked vertex takes no vertex of a seam", "[decimate]") {
  const Textured tube = unrolled_cylinder(12, 16);
  for (DecimateOptions options : ways()) {
    options.target.faces = 0;
    options.bounds.normal_deviation = 3.0;
    options.attributes = {tube.attribute(0.01)};
    for (std::uint32_t ring = 0; ring <= 12; ++ring) options.locked.vertices.push_back(16 * ring + 1);
    const Decimated d = run(tube.mesh, options);
    check_seams(tube, d);
    for (const std::uint32_t v : options.locked.vertices) {
      REQUIRE(d.vertex_map[v] != kInvalid);
      CHECK(d.source_vertex[d.vertex_map[v]] == v);
      CHECK(d.positions[d.vertex_map[v]] == tube.mesh.points[v]);
    }
  }
}

TEST_CASE("A cube with a normal for each side reduces to twelve triangles", "[decimate]") {
  const IndexedFaceSet mesh = test::fine_cube(8);
  const std::vector<float> normals = {-1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1};
  const auto side_of = [](const auto& a, const auto& b, const auto& c) {
    const DVec3 u(b - a), v(c - a);
    const DVec3 n(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
    for (int k = 0; k < 3; ++k)
      if (std::fabs(n[k]) > 0.5 * (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z)))
        return static_cast<std::uint32_t>(2 * k + (n[k] > 0 ? 1 : 0));
    return kInvalid;
  };
  std::vector<std::uint32_t> corners;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    corners.insert(corners.end(), 3,
                   side_of(mesh.points[face[0]], mesh.points[face[1]], mesh.points[face[2]]));
  }
  for (DecimateOptions options : ways()) {
    options.bounds.error = Length::absolute(1e-5);
    options.attributes = {{3, normals, corners, 1.0, AttributeKind::kNormal}};
    const Decimated d = run(mesh, options);
    CHECK(d.mesh.face_count() == 12);
    CHECK(d.error < 1e-6);
    CHECK(d.attribute_error < 1e-6);
    CHECK(d.attributes.source_corner.size() == 24);
    for (std::size_t c = 0; c < d.mesh.half_edge_count(); ++c) {
      const std::size_t f = c / 3 * 3;
      const auto p = [&](std::size_t k) { return d.positions[d.mesh.origins()[f + k]]; };
      const std::uint32_t side = side_of(p(0), p(1), p(2));
      REQUIRE(side != kInvalid);
      for (std::size_t k = 0; k < 3; ++k)
        CHECK(d.attributes.values[0][3 * d.attributes.corners[c] + k] == normals[3 * side + k]);
    }
  }
}

TEST_CASE("Normals stay of unit length", "[decimate]") {
  const IndexedFaceSet mesh = test::icosphere(4);
  std::vector<float> normals;
  for (const Vec3& p : mesh.points) normals.insert(normals.end(), {p.x, p.y, p.z});
  DecimateOptions options;
  options.target.ratio = 0.05;
  options.attributes = {{3, normals, {}, 0.1, AttributeKind::kNormal}};
  const Decimated d = run(mesh, options);
  for (std::size_t c = 0; c < d.mesh.half_edge_count(); ++c) {
    const float* const n = &d.attributes.values[0][3 * d.attributes.corners[c]];
    const Vec3 p = d.positions[d.mesh.origins()[c]];
    CHECK(std::fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-6f);
    const float length = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    CHECK((n[0] * p.x + n[1] * p.y + n[2] * p.z) / length > 0.99f);
  }
}

/// The least of a sum of squares w (row · x - right)², by normal equations in double precision.
class LeastSquares {
 public:
  explicit LeastSquares(std::size_t n) : n_(n), a_(n * n), b_(n) {}
  void add(double w, const std::vector<double>& row, double right) {
    for (std::size_t i = 0; i < n_; ++i) {
      for (std::size_t j = 0; j < n_; ++j) a_[i * n_ + j] += w * row[i] * row[j];
      b_[i] += w * row[i] * right;
    }
    terms_.push_back({w, row, right});
  }
  [[nodiscard]] std::vector<double> solve() const {
    std::vector<double> a = a_, x = b_;
    for (std::size_t k = 0; k < n_; ++k) {
      std::size_t pivot = k;
      for (std::size_t i = k; i < n_; ++i)
        if (std::fabs(a[i * n_ + k]) > std::fabs(a[pivot * n_ + k])) pivot = i;
      for (std::size_t j = 0; j < n_; ++j) std::swap(a[k * n_ + j], a[pivot * n_ + j]);
      std::swap(x[k], x[pivot]);
      for (std::size_t i = 0; i < n_; ++i) {
        if (i == k) continue;
        const double factor = a[i * n_ + k] / a[k * n_ + k];
        for (std::size_t j = k; j < n_; ++j) a[i * n_ + j] -= factor * a[k * n_ + j];
        x[i] -= factor * x[k];
      }
    }
    for (std::size_t k = 0; k < n_; ++k) x[k] /= a[k * n_ + k];
    return x;
  }
  [[nodiscard]] double at(const std::vector<double>& x) const {
    double sum = 0;
    for (const Term& t : terms_) {
      const double off = std::inner_product(t.row.begin(), t.row.end(), x.begin(), -t.right);
      sum += t.weight * off * off;
    }
    return sum;
  }

 private:
  struct Term {
    double weight;
    std::vector<double> row;
    double right;
  };
  std::size_t n_;
  std::vector<double> a_, b_;
  std::vector<Term> terms_;
};

struct Best {
  std::vector<double> x;                       // the point, then the values of each group
  std::map<std::uint32_t, std::size_t> group;  // of the values of the input
  double cost = 0, attributes = 0, faces = 0;
  LeastSquares functions;  // what the attributes cost
};

/// What vertices of a closed mesh become that collapse into one, by definition: planes and linear functions
/// of the faces at each of them.
Best dense(const Textured& t, const std::set<std::uint32_t>& of, double unit, double seam_weight) {
  const auto& points = t.mesh.points;
  const auto value = [&](std::size_t c, std::size_t k) {
    return static_cast<double>(t.values[t.components * t.corners[c] + k]);
  };
  Best best{{}, {}, 0, 0, 0, LeastSquares(0)};
  Sets sets(t.values.size() / t.components);
  std::vector<std::pair<std::size_t, std::size_t>> meets;  // faces and their corner at p or q
  for (std::size_t f = 0; f < t.mesh.face_count(); ++f) {
    std::vector<std::size_t> ends;
    for (std::size_t i = 0; i < 3; ++i)
      if (of.count(t.mesh.face(f)[i]) == 1) ends.push_back(i);
    for (const std::size_t i : ends) meets.emplace_back(f, i);
    for (std::size_t i = 1; i < ends.size(); ++i)
      sets.unite(t.corners[3 * f + ends[0]], t.corners[3 * f + ends[i]]);
  }
  std::map<std::uint32_t, std::size_t> roots;
  for (const auto& [f, i] : meets) {
    const std::uint32_t v = t.corners[3 * f + i];
    best.group[v] = roots.try_emplace(sets.find(v), roots.size()).first->second;
  }
  const std::size_t n = 3 + t.components * roots.size();
  LeastSquares planes(n), functions(n), all(n);
  for (const auto& [f, i] : meets) {
    const auto face = t.mesh.face(f);
    const DVec3 a(points[face[0]]), b(points[face[1]]), c(points[face[2]]);
    DVec3 normal = cross(b - a, c - a);
    const double twice = std::sqrt(dot(normal, normal));
    normal = normal / twice;
    std::vector<double> row(n, 0.0);
    for (int k = 0; k < 3; ++k) row[static_cast<std::size_t>(k)] = normal[k];
    planes.add(0.5 * twice, row, dot(normal, a));
    all.add(0.5 * twice, row, dot(normal, a));
    best.faces += 0.5 * twice;
    for (std::size_t k = 0; k < t.components; ++k) {
      // value(a) + gradient · (x - a), with gradient in the plane: from its products with two sides.
      const DVec3 u = b - a, v = c - a;
      const double du = value(3 * f + 1, k) - value(3 * f, k), dv = value(3 * f + 2, k) - value(3 * f, k);
      const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), det = uu * vv - uv * uv;
      const DVec3 gradient = u * ((du * vv - dv * uv) / det) + v * ((dv * uu - du * uv) / det);
      std::vector<double> linear(n, 0.0);
      for (int j = 0; j < 3; ++j) linear[static_cast<std::size_t>(j)] = gradient[j];
      linear[3 + t.components * best.group[t.corners[3 * f + i]] + k] = -1;
      functions.add(0.5 * twice * unit * unit, linear, dot(gradient, a) - value(3 * f, k));
      all.add(0.5 * twice * unit * unit, linear, dot(gradient, a) - value(3 * f, k));
    }
    // Seam planes on the sides of the face that end at this corner.
    for (std::size_t side = 0; side < 3 && seam_weight > 0; ++side) {
      const std::size_t to = (side + 1) % 3;
      if (side != i && to != i) continue;
      bool seam = false;
      for (std::size_t g = 0; g < t.mesh.face_count(); ++g)
        for (std::size_t s = 0; s < 3; ++s)
          if (t.mesh.face(g)[s] == face[to] && t.mesh.face(g)[(s + 1) % 3] == face[side])
            seam = t.corners[3 * g + s] != t.corners[3 * f + to] ||
                   t.corners[3 * g + (s + 1) % 3] != t.corners[3 * f + side];
      if (!seam) continue;
      const DVec3 from(points[face[side]]), e = DVec3(points[face[to]]) - from;
      const DVec3 across = cross(e, normal) / std::sqrt(dot(e, e));
      std::vector<double> wall(n, 0.0);
      for (int k = 0; k < 3; ++k) wall[static_cast<std::size_t>(k)] = across[k];
      planes.add(seam_weight * dot(e, e), wall, dot(across, from));
      all.add(seam_weight * dot(e, e), wall, dot(across, from));
    }
  }
  best.x = all.solve();
  best.cost = all.at(best.x);
  best.attributes = functions.at(best.x);
  best.functions = functions;
  return best;
}

double diagonal_of(const Textured& t) {
  DVec3 low(t.mesh.points[0]), high = low;
  for (const Vec3& p : t.mesh.points)
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], static_cast<double>(p[k]));
      high[k] = std::max(high[k], static_cast<double>(p[k]));
    }
  const DVec3 size = high - low;
  return std::sqrt(size.x * size.x + size.y * size.y + size.z * size.z);
}

/// The largest of the components' ranges.
double range_of(const Textured& t) {
  double range = 0;
  for (std::size_t k = 0; k < t.components; ++k) {
    float least = t.values[k], most = least;
    for (std::size_t i = k; i < t.values.size(); i += t.components) {
      least = std::min(least, t.values[i]);
      most = std::max(most, t.values[i]);
    }
    range = std::max(range, static_cast<double>(most - least));
  }
  return range;
}

/// What the attributes cost, at a vertex where it stands and with the values that it has.
double at_vertex(const Textured& t, const Best& best, std::uint32_t v) {
  std::vector<double> x(best.x.size());
  for (int k = 0; k < 3; ++k) x[static_cast<std::size_t>(k)] = static_cast<double>(t.mesh.points[v][k]);
  for (std::size_t corner = 0; corner < t.corners.size(); ++corner)
    for (std::size_t k = 0; k < t.components && t.mesh.corners[corner] == v; ++k)
      x[3 + t.components * best.group.at(t.corners[corner]) + k] =
          static_cast<double>(t.values[t.components * t.corners[corner] + k]);
  return best.functions.at(x);
}

Textured random_sphere(std::uint32_t seed) {
  Textured t;
  t.mesh = test::icosphere(1);
  t.components = 3;
  t.corners = t.mesh.corners;
  std::mt19937 random(seed);
  for (std::size_t i = 0; i < 3 * t.mesh.points.size(); ++i)
    t.values.push_back(static_cast<float>(random() % 1000) / 1000);
  test::jitter(t.mesh, 0.05f, seed);
  return t;
}

TEST_CASE("What a vertex that stays has absorbed counts with the values it has", "[decimate]") {
  constexpr double kWeight = 0.3;
  std::array<std::size_t, 2> twice{};
  for (std::uint32_t seed = 1; seed <= (test::kSanitized ? 8 : 20); ++seed) {
    const Textured t = random_sphere(seed);
    const double diagonal = diagonal_of(t), unit = kWeight * diagonal / range_of(t);
    const bool half_edge = seed % 2 == 0;
    for (std::uint32_t p = 0; p < t.mesh.points.size(); ++p)
      for (std::uint32_t other = 0; other < p; ++other) {
        // Farther apart they have no neighbour in common.
        if (glm::distance(t.mesh.points[p], t.mesh.points[other]) > 1.3f) continue;
        DecimateOptions options = ways()[half_edge ? 1 : 0];
        options.keep_history = true;
        options.bounds.normal_deviation = 3.0;
        options.target.vertices = t.mesh.points.size() - 2;
        options.attributes = {t.attribute(kWeight)};
        for (std::uint32_t v = 0; v < t.mesh.points.size(); ++v)
          if (v != p && v != other) options.locked.vertices.push_back(v);
        const Decimated d = run(t.mesh, options);
        if (d.history.size() != 2 || d.history[0].kept != d.history[1].kept) continue;
        const std::uint32_t kept = d.history[0].kept;
        if (kept == p || kept == other) continue;
        ++twice[half_edge ? 1 : 0];
        const Best one = dense(t, {kept, d.history[0].removed}, unit, 0),
                   both = dense(t, {kept, p, other}, unit, 0);
        const double expected =
            std::max(at_vertex(t, one, kept) / one.faces, at_vertex(t, both, kept) / both.faces);
        CHECK(d.attribute_error == Approx(std::sqrt(expected) / diagonal).epsilon(1e-3));
      }
  }
  CHECK(twice[0] > 5);
  CHECK(twice[1] > 5);
}

TEST_CASE("One collapse with attributes is the least squares solution", "[decimate]") {
  Textured smooth = random_sphere(7);
  Textured split = sphere_of_octants(2);
  test::jitter(split.mesh, 0.05f, 3);
  for (const Textured* t : {&smooth, &split}) {
    constexpr double kWeight = 0.3;
    DecimateOptions options;
    options.keep_history = true;
    options.target.faces = t->mesh.face_count() - 2;
    options.attributes = {t->attribute(kWeight)};
    const double diagonal = diagonal_of(*t), range = range_of(*t);
    // Vertices of seams only, so that both cases of the merging of wedges come about.
    const Seams seams(t->mesh.corners, t->corners);
    for (std::uint32_t v = 0; v < t->mesh.points.size(); ++v) {
      const auto found = seams.degree.find(v);
      if (!seams.degree.empty() && (found == seams.degree.end() || found->second != 2))
        options.locked.vertices.push_back(v);
    }
    options.bounds.normal_deviation = 3.0;
    const Decimated d = run(t->mesh, options);
    REQUIRE(d.history.size() == 1);
    const Collapse<Vec3>& c = d.history[0];
    const double unit = kWeight * diagonal / range;
    const Best best = dense(*t, {c.kept, c.removed}, unit, 10.0);
    CHECK(best.group.size() == (seams.degree.empty() ? 2 : 4));
    for (int k = 0; k < 3; ++k)
      CHECK(std::fabs(static_cast<double>(c.position[k]) - best.x[static_cast<std::size_t>(k)]) < 2e-4);
    const std::uint32_t kept = d.vertex_map[c.kept];
    std::set<std::size_t> groups;
    for (std::size_t corner = 0; corner < d.mesh.half_edge_count(); ++corner) {
      if (d.mesh.origins()[corner] != kept) continue;
      const std::size_t wedge = d.attributes.corners[corner];
      const std::size_t group = best.group.at(t->corners[d.attributes.source_corner[wedge]]);
      groups.insert(group);
      for (std::size_t k = 0; k < t->components; ++k)
        CHECK(std::fabs(static_cast<double>(d.attributes.values[0][t->components * wedge + k]) -
                        best.x[3 + t->components * group + k]) < 2e-4 * range);
    }
    CHECK(groups.size() == (seams.degree.empty() ? 1 : 2));
    const double expected = std::sqrt(best.attributes / best.faces) / diagonal;
    CHECK(d.attribute_error == Approx(expected).epsilon(1e-3));
    // A half-edge collapse leaves the values of the vertex that is kept.
    DecimateOptions to_end = options;
    to_end.operation = DecimateOperation::kHalfEdgeCollapse;
    const Decimated half = run(t->mesh, to_end);
    REQUIRE(half.history.size() == 1);
    const std::uint32_t stays = half.history[0].kept;
    const Best at_end = dense(*t, {stays, half.history[0].removed}, unit, 10.0);
    CHECK(half.attribute_error ==
          Approx(std::sqrt(at_vertex(*t, at_end, stays) / at_end.faces) / diagonal).epsilon(1e-3));

    // No other edge that may go costs less than by what the queue's order leaves open.
    if (!seams.degree.empty()) continue;
    const HalfEdgeMesh mesh = half_edges(t->mesh);
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h)
      CHECK(best.cost <=
            1.08 * dense(*t, {mesh.origin(HalfEdgeId(h)).index, mesh.target(HalfEdgeId(h)).index}, unit, 10.0)
                       .cost);
  }
}

/// The vertex buffer that engines have: a vertex for each value of the only attribute.
struct Buffers {
  std::vector<Vec3> points;
  std::vector<float> values;
  std::vector<std::uint32_t> indices;
};
Buffers buffers_of(const Textured& t) {
  Buffers b;
  b.points.resize(t.values.size() / t.components);
  b.values = t.values;
  b.indices = t.corners;
  for (std::size_t c = 0; c < t.corners.size(); ++c)
    b.points[t.corners[c]] = t.mesh.points[t.mesh.corners[c]];
  return b;
}

TEST_CASE("An index buffer is decimated over its own vertices", "[decimate]") {
  for (const Textured& t : {unrolled_cylinder(40, 48), sphere_of_octants(4)}) {
    Buffers b = buffers_of(t);
    // Triangles of no area at a seam, as some engines join their strips.
    const auto twin =
        std::find_if(b.points.begin() + 1, b.points.end(), [&](const Vec3& p) { return p == b.points[0]; }) -
        b.points.begin();
    if (static_cast<std::size_t>(twin) < b.points.size())
      b.indices.insert(b.indices.begin(), {0, static_cast<std::uint32_t>(twin), b.indices[1]});
    DecimateOptions options = ways()[1];
    options.target.ratio = 0.1;
    options.attributes = {{t.components, b.values, {}, 0.01, AttributeKind::kPlain}};
    const auto result = decimate_index_buffer(b.points, b.indices, options);
    if (!result) FAIL(result.error().describe());
    CHECK(result->stop == DecimateStop::kTargetReached);
    CHECK(result->indices.size() / 3 <= t.mesh.face_count() / 10 + 1);
    REQUIRE(result->source_face.size() == result->indices.size() / 3);

    // The same as over corners with attributes.
    options.attributes = {t.attribute(0.01)};
    const Decimated d = run(t.mesh, options);
    CHECK(result->error == d.error);
    CHECK(result->attribute_error == d.attribute_error);
    REQUIRE(result->indices.size() == d.attributes.corners.size());
    for (std::size_t c = 0; c < result->indices.size(); ++c) {
      const std::uint32_t v = result->indices[c];
      REQUIRE(v < b.points.size());
      CHECK(b.points[v] == d.positions[d.mesh.origins()[c]]);
      for (std::size_t k = 0; k < t.components; ++k)
        CHECK(b.values[t.components * v + k] ==
              d.attributes.values[0][t.components * d.attributes.corners[c] + k]);
    }
    for (std::size_t f = 0; f < d.source_face.size(); ++f)
      CHECK(result->source_face[f] == d.source_face[f] + (b.indices.size() - t.corners.size()) / 3);
    // Without cracks: vertices at one place made one, it is a manifold of the input's boundary.
    std::map<std::array<float, 3>, std::uint32_t> at;
    IndexedFaceSet welded;
    for (const std::uint32_t v : result->indices) {
      const Vec3 p = b.points[v];
      const auto [place, is_new] =
          at.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(welded.points.size()));
      if (is_new) welded.points.push_back(p);
      welded.corners.push_back(place->second);
    }
    CHECK(half_edges(welded).boundary_loops().size() == half_edges(t.mesh).boundary_loops().size());
    Textured level = t;
    level.mesh = welded;
    level.corners = result->indices;
    const Seams before(t.mesh.corners, t.corners), after(level.mesh.corners, level.corners);
    CHECK(after.charts == before.charts);
    CHECK(after.loops() == before.loops());
  }
}

TEST_CASE("Vertices at one place stay apart without attributes, and locks hold", "[decimate]") {
  const Textured t = unrolled_cylinder(20, 24);
  const Buffers b = buffers_of(t);
  DecimateOptions options = ways()[1];
  options.target.faces = 0;
  options.bounds.normal_deviation = 3.0;
  options.locked.vertices = {24 + 25 * 3, 12 + 25 * 10};  // the first on the seam, by its second name
  options.locked.faces = {100};
  options.locked.edges = {3 * 400 + 2};
  const auto result = decimate_index_buffer(b.points, b.indices, options);
  if (!result) FAIL(result.error().describe());
  const std::set<std::uint32_t> used(result->indices.begin(), result->indices.end());
  for (const std::uint32_t v : {25u * 3, 24u + 25 * 3, 12u + 25 * 10, b.indices[300], b.indices[301],
                                b.indices[302], b.indices[1202], b.indices[1200]})
    CHECK(used.count(v) == 1);
  for (std::size_t i = 0; i < result->indices.size(); i += 3) {  // u never runs back over the seam
    float low = 1, high = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const float u = b.values[2 * result->indices[i + k]];
      low = std::min(low, u);
      high = std::max(high, u);
    }
    CHECK(high - low < 0.6f);
  }
  const auto code = [&](const DecimateOptions& o, std::span<const std::uint32_t> indices) {
    return decimate_index_buffer(b.points, indices, o).error().code;
  };
  CHECK(code(options, std::span(b.indices).first(4)) == ErrorCode::kUsage);
  const std::vector<std::uint32_t> beyond = {0, 1, static_cast<std::uint32_t>(b.points.size())};
  CHECK(code(options, beyond) == ErrorCode::kUsage);
  DecimateOptions bad = options;
  bad.corner_groups = b.indices;
  CHECK(code(bad, b.indices) == ErrorCode::kUsage);
  bad = options;
  bad.attributes = {{2, std::span(b.values).first(10), {}, 1.0, AttributeKind::kPlain}};
  CHECK(code(bad, b.indices) == ErrorCode::kUsage);
  bad = options;
  bad.locked.vertices = {static_cast<std::uint32_t>(b.points.size())};
  CHECK(code(bad, b.indices) == ErrorCode::kUsage);
}

TEST_CASE("Attributes of no weight change nothing but what is returned", "[decimate]") {
  const IndexedFaceSet mesh = test::torus(40, 24);
  std::vector<float> values(mesh.points.size());
  for (std::size_t v = 0; v < values.size(); ++v) values[v] = mesh.points[v].z;
  for (DecimateOptions options : ways()) {
    options.target.ratio = 0.1;
    const Decimated without = run(mesh, options);
    options.attributes = {{1, values, {}, 0.0, AttributeKind::kPlain}};
    const Decimated with = run(mesh, options);
    CHECK(with.positions == without.positions);
    CHECK(corners_of(with) == corners_of(without));
    CHECK(with.error == Approx(without.error));
    CHECK(with.attribute_error < 1e-6);
  }
}

TEST_CASE("Attributes that decimation does not take", "[decimate]") {
  const IndexedFaceSet mesh = test::grid(3, 3);
  const HalfEdgeMesh connectivity = half_edges(mesh);
  const std::vector<float> values(mesh.points.size());
  const std::vector<std::uint32_t> corners(mesh.corners.size());
  const auto code = [&](const DecimateAttribute& attribute) {
    DecimateOptions options;
    options.attributes = {attribute};
    const auto result = decimate(connectivity, mesh.points, options);
    REQUIRE(!result);
    return result.error().code;
  };
  using K = AttributeKind;
  CHECK(code({1, values, {}, -1.0, K::kPlain}) == ErrorCode::kUsage);
  CHECK(code({0, values, {}, 1.0, K::kPlain}) == ErrorCode::kUsage);
  CHECK(code({1, values, {}, 1.0, K::kNormal}) == ErrorCode::kUsage);
  CHECK(code({1, std::span(values).first(5), {}, 1.0, K::kPlain}) == ErrorCode::kUsage);
  CHECK(code({1, values, std::span(corners).first(5), 1.0, K::kPlain}) == ErrorCode::kUsage);
  std::vector<std::uint32_t> beyond = corners;
  beyond.back() = static_cast<std::uint32_t>(values.size());
  CHECK(code({1, values, beyond, 1.0, K::kPlain}) == ErrorCode::kUsage);
  std::vector<float> bad = values;
  bad[3] = std::numeric_limits<float>::quiet_NaN();
  CHECK(code({1, bad, {}, 1.0, K::kPlain}) == ErrorCode::kUnsuitable);
}

}  // namespace
}  // namespace vkmesh
