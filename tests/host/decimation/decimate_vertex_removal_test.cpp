#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/math/vec.h>

#include "decimation/cost/retriangulation.h"
#include "support/data.h"
#include "support/shapes.h"
#include "support/vectors.h"

namespace vkmesh {
namespace {

using detail::RetriangulationAttributes, detail::RetriangulationBatch;
using test::cross, test::dot, test::length;

Decimated remove_vertices(const IndexedFaceSet& mesh, DecimateOptions options) {
  options.operation = DecimateOperation::kVertexRemoval;
  auto result = decimate(test::half_edges(mesh), mesh.points, options);
  if (!result) FAIL(result.error().describe());
  REQUIRE(validate(result->mesh));
  return std::move(*result);
}

using Triangle = std::array<std::size_t, 3>;
using Triangulation = std::vector<Triangle>;

/// All of the polygon with corners first..last.
std::vector<Triangulation> all_triangulations(std::size_t first, std::size_t last) {
  if (last == first + 1) return {{}};
  std::vector<Triangulation> all;
  for (std::size_t middle = first + 1; middle < last; ++middle)
    for (const Triangulation& left : all_triangulations(first, middle))
      for (const Triangulation& right : all_triangulations(middle, last)) {
        Triangulation both = left;
        both.insert(both.end(), right.begin(), right.end());
        both.push_back({first, middle, last});
        all.push_back(std::move(both));
      }
  return all;
}

/// A vertex at the origin, its neighbours and the planes it stands for, in double.
struct Star {
  std::vector<DVec3> ring;
  bool closed = true;
  struct Plane {
    DVec3 normal;
    double offset, weight;
  };
  std::vector<Plane> planes;

  std::size_t seam = 0;  // the neighbour at its other end, if one runs through the first

  [[nodiscard]] std::size_t size() const { return ring.size(); }
  [[nodiscard]] bool on_curve() const { return !closed || seam > 0; }
  [[nodiscard]] std::size_t sides() const { return seam > 0 ? 2 : 1; }
  /// Whether neighbour i stands on that side of the seam.
  [[nodiscard]] bool has(std::size_t side, std::size_t i) const {
    return seam == 0 || (side == 0 ? i <= seam : i >= seam || i == 0);
  }
  /// On its new edge, where it goes to on a boundary or seam, and how far along it.
  [[nodiscard]] std::pair<DVec3, double> on_edge() const {
    const DVec3 &p = ring[0], d = ring[seam > 0 ? seam : size() - 1] - p;
    const double t = std::clamp(-dot(p, d) / dot(d, d), 0.0, 1.0);
    return {p + d * t, t};
  }
  [[nodiscard]] std::size_t faces() const { return closed ? size() : size() - 1; }
  [[nodiscard]] DVec3 face(std::size_t i) const { return cross(ring[i], ring[(i + 1) % size()]); }
  [[nodiscard]] DVec3 up() const {
    DVec3 sum{0.0};
    for (std::size_t i = 0; i < faces(); ++i) sum += face(i);
    return sum / length(sum);
  }
  [[nodiscard]] double area() const {
    double sum = 0;
    for (std::size_t i = 0; i < faces(); ++i) sum += length(face(i)) / 2;
    return sum;
  }
  [[nodiscard]] double quadric(const DVec3& x) const {
    double sum = 0;
    for (const Plane& p : planes) {
      const double d = dot(p.normal, x) - p.offset;
      sum += p.weight * d * d;
    }
    return sum;
  }
};

/// Coordinates in which the star's normal is the third axis.
struct Seen {
  DVec3 x, y, z;
  explicit Seen(const DVec3& up) : z(up) {
    x = cross(std::fabs(up.x) < 0.5 ? DVec3(1, 0, 0) : DVec3(0, 1, 0), up);
    x /= length(x);
    y = cross(up, x);
  }
  [[nodiscard]] DVec3 operator()(const DVec3& p) const { return {dot(x, p), dot(y, p), dot(z, p)}; }
};

/// Twice the area of the shadow.
double shadow(const DVec3& a, const DVec3& b, const DVec3& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The error of a triangulation, from where lines cross each other in the shadow; infinite when it is not
/// legal. `margin` becomes how near anything came to deciding otherwise.
double error_of(const Star& star, const Triangulation& triangles, double cos_deviation, double& margin) {
  const std::size_t n = star.size();
  const Seen seen(star.up());
  std::vector<DVec3> p;
  for (const DVec3& r : star.ring) p.push_back(seen(r));
  bool legal = true;
  const auto require = [&](double value) {
    margin = std::min(margin, std::fabs(value));
    legal = legal && value > 0;
  };
  double error = 0;
  const DVec3 v{0.0};
  for (const auto& [a, b, c] : triangles) {
    const DVec3 normal = cross(star.ring[b] - star.ring[a], star.ring[c] - star.ring[a]);
    require(shadow(p[a], p[b], p[c]) / length(normal) - 0.05);
    for (const auto& [i, j] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      if ((i + 1) % n == j && i < star.faces())
        require(dot(normal, star.face(i)) / (length(normal) * length(star.face(i))) - cos_deviation);
    const double va = shadow(v, p[b], p[c]), vb = shadow(v, p[c], p[a]), vc = shadow(v, p[a], p[b]);
    margin = std::min({margin, std::fabs(va), std::fabs(vb), std::fabs(vc)});
    if (va > 0 && vb > 0 && vc > 0) {
      const DVec3 below = star.up() * ((va * p[a].z + vb * p[b].z + vc * p[c].z) / (va + vb + vc));
      if (!star.on_curve()) {
        error += star.quadric(below);
      } else {  // planes through v: where v itself goes is told by the new edge
        for (const Star::Plane& plane : star.planes)
          error += plane.weight * dot(plane.normal, below) * dot(plane.normal, below);
      }
    }
    // Each of the mesh's new edges once: as the last edge of the triangle on one side.
    if (!(c > a + 1 && !(star.closed && a == 0 && c + 1 == n))) continue;
    for (std::size_t s = 0; s < n; ++s) {
      if (s == a || s == c) continue;
      // v + t (s - v) = a + u (c - a).
      const DVec3 d = p[c] - p[a];
      const double det = p[s].x * d.y - p[s].y * d.x;
      const double t = (p[a].x * d.y - p[a].y * d.x) / det, u = (p[a].x * p[s].y - p[a].y * p[s].x) / det;
      if (!(t > 0 && t < 1 && u > 0 && u < 1)) continue;
      const double apart = t * p[s].z - (p[a].z + u * d.z);
      double weight = 0;
      if (star.closed || s + 1 < n) weight += length(star.face(s)) / 4;
      if (star.closed || s > 0) weight += length(star.face((s + n - 1) % n)) / 4;
      error += weight * apart * apart;
    }
  }
  if (star.on_curve()) error += star.quadric(star.on_edge().first);
  return legal ? error : std::numeric_limits<double>::infinity();
}

/// An attribute at a star, values less that of the vertex on each side.
struct Attribute {
  double cost = 1;
  struct OnSide {
    std::vector<double> ring;
    double off = 0;  // of the mean function
    DVec3 gradient{0.0};
  };
  std::array<OnSide, 2> side;
};
struct Attributes {
  std::vector<Attribute> all;
  std::array<double, 2> weight{};
  Star left;  // whose planes are what is left for the best values
};

/// What attributes add to the error of a triangulation that is legal.
double error_of(const Star& star, const Attributes& attributes, const Triangulation& triangles) {
  const std::size_t n = star.size();
  const Seen seen(star.up());
  std::vector<DVec3> p;
  for (const DVec3& r : star.ring) p.push_back(seen(r));
  const DVec3 v{0.0};
  // Where neighbour i takes over what v stands for.
  const auto taken_by = [&](std::size_t i) {
    double sum = attributes.left.quadric(star.ring[i]);
    for (const Attribute& a : attributes.all)
      for (std::size_t side = 0; side < star.sides(); ++side) {
        const Attribute::OnSide& on = a.side[side];
        const double off = on.off + dot(on.gradient, star.ring[i]) - on.ring[i];
        sum += attributes.weight[side] * a.cost * off * off;
      }
    return sum;
  };
  double error = 0;
  for (const auto& [a, b, c] : triangles) {
    const double va = shadow(v, p[b], p[c]), vb = shadow(v, p[c], p[a]), vc = shadow(v, p[a], p[b]);
    if (!star.on_curve() && va > 0 && vb > 0 && vc > 0)
      error += (va * taken_by(a) + vb * taken_by(b) + vc * taken_by(c)) / (va + vb + vc);
    if (!(c > a + 1 && !(star.closed && a == 0 && c + 1 == n))) continue;
    for (std::size_t s = 0; s < n; ++s) {
      if (s == a || s == c) continue;
      const DVec3 d = p[c] - p[a];
      const double det = p[s].x * d.y - p[s].y * d.x;
      const double t = (p[a].x * d.y - p[a].y * d.x) / det, u = (p[a].x * p[s].y - p[a].y * p[s].x) / det;
      if (!(t > 0 && t < 1 && u > 0 && u < 1)) continue;
      double weight = 0;
      if (star.closed || s + 1 < n) weight += length(star.face(s)) / 4;
      if (star.closed || s > 0) weight += length(star.face((s + n - 1) % n)) / 4;
      for (std::size_t of = 0; of < star.sides(); ++of) {
        if (!star.has(of, a) || !star.has(of, c) || !star.has(of, s)) continue;
        for (const Attribute& attribute : attributes.all) {
          const auto& ring = attribute.side[of].ring;
          const double apart = t * ring[s] - (ring[a] + u * (ring[c] - ring[a]));
          error += weight * attribute.cost * apart * apart;
        }
      }
    }
  }
  if (!star.on_curve()) return error;
  const double t = star.on_edge().second;
  return error + (1 - t) * taken_by(0) + t * taken_by(star.seam > 0 ? star.seam : n - 1);
}

/// The quadric of a star's planes, into a lane.
template <class Batch>
void put_quadric(const Star& star, std::size_t lane, Batch& batch) {
  std::array<double, 6> a{};
  std::array<double, 3> b{};
  double c = 0;
  for (const auto& [m, d, w] : star.planes) {
    const std::array<double, 6> products = {m.x * m.x, m.x * m.y, m.x * m.z, m.y * m.y, m.y * m.z, m.z * m.z};
    for (std::size_t k = 0; k < 6; ++k) a[k] += w * products[k];
    for (int k = 0; k < 3; ++k) b[static_cast<std::size_t>(k)] -= w * d * m[k];
    c += w * d * d;
  }
  for (std::size_t k = 0; k < 6; ++k) batch.a[k][lane] = static_cast<float>(a[k]);
  for (std::size_t k = 0; k < 3; ++k) batch.b[k][lane] = static_cast<float>(b[k]);
  batch.c[lane] = static_cast<float>(c);
}

void put(const Star& star, std::size_t lane, RetriangulationBatch& batch) {
  for (std::size_t i = 0; i < star.size(); ++i)
    for (int k = 0; k < 3; ++k)
      batch.ring[i][static_cast<std::size_t>(k)][lane] = static_cast<float>(star.ring[i][k]);
  put_quadric(star, lane, batch);
  batch.closed[lane] = star.closed ? 1.0f : 0.0f;
}

void put(const Star& star, const Attributes& attributes, std::size_t lane, RetriangulationBatch& batch,
         RetriangulationAttributes& attribute_batch) {
  put(star, lane, batch);
  put_quadric(attributes.left, lane, attribute_batch);
  attribute_batch.split[lane] = star.seam > 0 ? 1 : 0;
  const std::size_t last = star.seam > 0 ? star.seam : star.size() - 1;
  attribute_batch.last[lane] = static_cast<std::int32_t>(last);
  for (std::size_t b = 1; b < star.size(); ++b)
    for (std::size_t a = 0; a < b; ++a)
      batch.barred[RetriangulationBatch::pair(a, b)][lane] =
          star.seam > 0 && a > 0 && a < last && b > last ? HUGE_VALF : 0.0f;
  for (std::size_t side = 0; side < 2; ++side) {
    attribute_batch.weight[side][lane] = static_cast<float>(attributes.weight[side]);
    for (std::size_t k = 0; k < attributes.all.size(); ++k) {
      const Attribute::OnSide& on = attributes.all[k].side[side];
      RetriangulationAttributes::OnSide& out = attribute_batch.components[k].side[side];
      out.off[lane] = static_cast<float>(on.off);
      for (int j = 0; j < 3; ++j)
        out.gradient[static_cast<std::size_t>(j)][lane] = static_cast<float>(on.gradient[j]);
      for (std::size_t i = 0; i < star.size(); ++i) out.ring[i][lane] = static_cast<float>(on.ring[i]);
    }
  }
}

Triangulation triangulation_in(const RetriangulationBatch& batch, std::size_t lane, std::size_t first,
                               std::size_t last) {
  if (last == first + 1) return {};
  const auto middle = static_cast<std::size_t>(batch.third[RetriangulationBatch::pair(first, last)][lane]);
  Triangulation all = triangulation_in(batch, lane, first, middle);
  const Triangulation right = triangulation_in(batch, lane, middle, last);
  all.insert(all.end(), right.begin(), right.end());
  all.push_back({first, middle, last});
  return all;
}

/// A star about the third axis, then turned; its planes are those of its faces and some others.
Star random_star(std::size_t n, bool closed, std::mt19937& random) {
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  Star star;
  star.closed = closed;
  const double whole = closed ? 2 * std::numbers::pi : uniform(1.5, 5.5);
  const double steps = static_cast<double>(closed ? n : n - 1);
  const DVec3 tilt(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
  const Seen turn(tilt / length(tilt));
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = (static_cast<double>(i) + uniform(-0.3, 0.3)) * whole / steps, r = uniform(0.6, 1.4);
    const DVec3 p = r * DVec3(std::cos(angle), std::sin(angle), uniform(-0.5, 0.5));
    const DVec3 turned = p.x * turn.x + p.y * turn.y + p.z * turn.z;
    star.ring.emplace_back(Vec3(turned));  // what a float holds
  }
  for (std::size_t i = 0; i < star.faces(); ++i)
    star.planes.push_back({star.face(i) / length(star.face(i)), 0, length(star.face(i)) / 2});
  const DVec3 up = star.up();
  star.planes.push_back({up, uniform(-0.1, 0.1), uniform(0, 1)});
  return star;
}

}  // namespace

TEST_CASE("decimation: a hole is filled with the best of all triangulations", "[decimate]") {
  std::mt19937 random(5);
  RetriangulationBatch batch;
  std::size_t compared = 0, impossible = 0;
  for (std::size_t n = 3; n <= 8; ++n) {
    const std::vector<Triangulation> all = all_triangulations(0, n - 1);
    for (int round = 0; round < 60; ++round) {
      std::vector<Star> stars;
      for (std::size_t lane = 0; lane < RetriangulationBatch::kLanes; ++lane) {
        stars.push_back(random_star(n, random() % 3 != 0, random));
        put(stars.back(), lane, batch);
      }
      const double cos_deviation = round % 2 == 0 ? 0.25 : 0.8;
      detail::retriangulate(batch, n, static_cast<float>(cos_deviation));
      for (std::size_t lane = 0; lane < RetriangulationBatch::kLanes; ++lane) {
        const Star& star = stars[lane];
        double margin = 1;
        const Seen seen(star.up());
        bool looks_up = true;
        for (std::size_t i = 0; i < star.faces(); ++i) {
          const double area = shadow(DVec3(0.0), seen(star.ring[i]), seen(star.ring[(i + 1) % n]));
          margin = std::min(margin, std::fabs(area));
          looks_up = looks_up && area > 0;
        }
        double least = std::numeric_limits<double>::infinity();
        for (const Triangulation& triangulation : all)
          least = std::min(least, error_of(star, triangulation, cos_deviation, margin));
        if (margin < 1e-4) continue;  // rounding of floats may decide otherwise
        ++compared;
        INFO(n << " neighbours, closed " << star.closed << ", round " << round << ", lane " << lane);
        if (!looks_up || std::isinf(least)) {
          CHECK(std::isinf(batch.error[lane]));
          ++impossible;
          continue;
        }
        // Some hundred roundings of numbers of about 1, and what the lengths of n edges of up to 3 may
        // decide.
        const double rounding = 200.0 / (1 << 24),
                     by_length = 1e-7 * star.area() * 9 * static_cast<double>(n);
        CHECK(batch.error[lane] >= least - rounding);
        CHECK(batch.error[lane] <= least + rounding + by_length);
        const double found = error_of(star, triangulation_in(batch, lane, 0, n - 1), cos_deviation, margin);
        CHECK(batch.error[lane] == Approx(found).margin(rounding));
      }
    }
  }
  CHECK(compared > 3000);
  CHECK(impossible > 100);
  CHECK(compared - impossible > 1500);
}

TEST_CASE("decimation: attributes take part in which triangulation is the best, on each side of a seam",
          "[decimate]") {
  std::mt19937 random(7);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  RetriangulationBatch batch;
  RetriangulationAttributes attribute_batch;
  constexpr std::array<double, 2> kCosts = {1, 0.3};
  for (const double cost : kCosts) attribute_batch.components.emplace_back().cost = static_cast<float>(cost);
  std::size_t within = 0, boundary = 0, on_seam = 0, decided = 0;
  for (std::size_t n = 3; n <= 7; ++n) {
    const std::vector<Triangulation> all = all_triangulations(0, n - 1);
    for (int round = 0; round < (test::kSanitized ? 10 : 60); ++round) {
      std::vector<Star> stars;
      std::vector<Attributes> attributes;
      for (std::size_t lane = 0; lane < RetriangulationBatch::kLanes; ++lane) {
        Star star = random_star(n, random() % 3 != 0, random);
        if (star.closed && random() % 2 == 0) star.seam = 1 + random() % (n - 1);
        Attributes at;
        for (const double cost : kCosts) {
          at.all.push_back({cost, {}});
          for (Attribute::OnSide& on : at.all.back().side) {
            on.off = uniform(-0.2, 0.2);
            on.gradient = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
            for (std::size_t i = 0; i < n; ++i) on.ring.push_back(uniform(-1, 1));
          }
        }
        at.weight = {uniform(0, 2), uniform(0, 2)};
        const DVec3 normal(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        at.left.planes = {{normal, uniform(-0.1, 0.1), uniform(0, 0.5)}};
        put(star, at, lane, batch, attribute_batch);
        stars.push_back(std::move(star));
        attributes.push_back(std::move(at));
      }
      detail::retriangulate(batch, n, 0.25f, &attribute_batch);
      for (std::size_t lane = 0; lane < RetriangulationBatch::kLanes; ++lane) {
        const Star& star = stars[lane];
        double margin = 1, least = HUGE_VAL, least_without = HUGE_VAL;
        const Triangulation* plain = nullptr;
        const Seen seen(star.up());
        for (std::size_t i = 0; i < star.faces(); ++i)
          margin = std::min(margin, shadow(DVec3(0.0), seen(star.ring[i]), seen(star.ring[(i + 1) % n])));
        for (const Triangulation& triangles : all) {
          const bool crosses = std::any_of(triangles.begin(), triangles.end(), [&](const Triangle& t) {
            return star.seam > 0 && t[0] > 0 && t[0] < star.seam && t[2] > star.seam;
          });
          const bool keeps = star.seam == 0 || star.seam == 1 || star.seam + 1 == n ||
                             std::any_of(triangles.begin(), triangles.end(), [&](const Triangle& t) {
                               return t[0] == 0 && (t[1] == star.seam || t[2] == star.seam);
                             });
          if (crosses || !keeps) continue;
          const double without = error_of(star, triangles, 0.25, margin);
          if (!(without < HUGE_VAL)) continue;
          least = std::min(least, without + error_of(star, attributes[lane], triangles));
          if (without < least_without) plain = &triangles;
          least_without = std::min(least_without, without);
        }
        if (margin < 1e-4 || !(least < HUGE_VAL)) continue;
        INFO(n << " neighbours, closed " << star.closed << ", seam " << star.seam << ", lane " << lane);
        const double rounding = 400.0 / (1 << 24),
                     by_length = 1e-7 * star.area() * 9 * static_cast<double>(n);
        const Triangulation found = triangulation_in(batch, lane, 0, n - 1);
        CHECK(batch.error[lane] == Approx(error_of(star, found, 0.25, margin)).margin(rounding));
        CHECK(attribute_batch.error[lane] ==
              Approx(error_of(star, attributes[lane], found)).margin(rounding));
        CHECK(batch.error[lane] + attribute_batch.error[lane] >= least - rounding);
        CHECK(batch.error[lane] + attribute_batch.error[lane] <= least + rounding + by_length);
        ++(star.seam > 0 ? on_seam : star.closed ? within : boundary);
        if (least_without + error_of(star, attributes[lane], *plain) > 1.01 * least) ++decided;
      }
    }
  }
  const std::size_t enough = test::kSanitized ? 30 : 300;
  CHECK(within > enough);
  CHECK(boundary > enough);
  CHECK(on_seam > enough);
  CHECK(decided > enough);
}

namespace {

/// What a vertex stands for: mean functions about its place, the area, and what is left for the best values.
struct Means {
  std::vector<DVec3> gradient;
  std::vector<double> value;
  double weight = 0;
  std::vector<Star::Plane> left;
};

struct Face {
  std::array<std::uint32_t, 3> corners;
  std::uint32_t chart;
};
using Faces = std::vector<Face>;

/// Those of a vertex, which has its place first in each.
Faces faces_at(const Faces& faces, std::uint32_t v) {
  Faces at;
  for (auto [corners, chart] : faces) {
    const auto found = std::find(corners.begin(), corners.end(), v);
    if (found == corners.end()) continue;
    std::rotate(corners.begin(), found, corners.end());
    at.push_back({corners, chart});
  }
  return at;
}

/// The same in the order in which they follow each other; the first begins a chart if any does.
Faces fan_at(const Faces& faces, std::uint32_t v) {
  const Faces at = faces_at(faces, v);
  Faces fan = {at[0]};
  while (fan.size() < at.size())
    fan.push_back(*std::find_if(at.begin(), at.end(),
                                [&](const Face& face) { return face.corners[1] == fan.back().corners[2]; }));
  for (std::size_t i = 0; i < at.size() && fan.front().chart == fan.back().chart; ++i)
    std::rotate(fan.begin(), fan.begin() + 1, fan.end());
  return fan;
}

/// Two components for each vertex in each chart.
struct Values {
  std::size_t vertices;
  std::vector<float> all;
  [[nodiscard]] double operator()(std::uint32_t chart, std::uint32_t v, std::size_t k) const {
    return static_cast<double>(all[2 * (chart * vertices + v) + k]);
  }
};

Means means_of(const IndexedFaceSet& mesh, const Faces& faces, const Values& values, double cost,
               std::uint32_t v, std::uint32_t chart) {
  Means means{std::vector<DVec3>(2, DVec3(0.0)), {values(chart, v, 0), values(chart, v, 1)}, 0, {}};
  std::vector<std::pair<double, std::array<DVec3, 2>>> all;
  for (const Face& face : faces_at(faces, v)) {
    if (face.chart != chart) continue;
    const auto [a, b, c] = face.corners;
    const DVec3 at(mesh.points[a]), u = DVec3(mesh.points[b]) - at, w = DVec3(mesh.points[c]) - at;
    const double uu = dot(u, u), uw = dot(u, w), ww = dot(w, w), det = uu * ww - uw * uw;
    auto& [area, gradients] = all.emplace_back(length(cross(u, w)) / 2, std::array<DVec3, 2>());
    for (std::size_t k = 0; k < 2; ++k) {
      const double du = values(chart, b, k) - values(chart, a, k),
                   dw = values(chart, c, k) - values(chart, a, k);
      gradients[k] = u * ((du * ww - dw * uw) / det) + w * ((dw * uu - du * uw) / det);
    }
    means.weight += area;
  }
  for (const auto& [area, gradients] : all)
    for (std::size_t k = 0; k < 2; ++k) means.gradient[k] += gradients[k] * (area / means.weight);
  for (const auto& [area, gradients] : all)
    for (std::size_t k = 0; k < 2; ++k)
      means.left.push_back({gradients[k] - means.gradient[k], 0, area * cost});
  return means;
}

/// A share of what a vertex at `from` stood for becomes part of that of one at the origin.
void absorb(Means& kept, const Means& gone, const DVec3& from, double share, double cost) {
  for (Star::Plane plane : gone.left) {
    plane.offset += dot(plane.normal, from);
    plane.weight *= share;
    kept.left.push_back(plane);
  }
  const double weight = share * gone.weight, all = kept.weight + weight;
  for (std::size_t k = 0; k < kept.value.size(); ++k) {
    const double value = gone.value[k] - dot(gone.gradient[k], from);
    const DVec3 apart = gone.gradient[k] - kept.gradient[k];
    kept.left.push_back({apart, kept.value[k] - value, cost * kept.weight * weight / all});
    kept.gradient[k] += apart * (weight / all);
    kept.value[k] += (value - kept.value[k]) * (weight / all);
  }
  kept.weight = all;
}

}  // namespace

TEST_CASE("decimation: what neighbours get of a vertex that goes counts when they go, in attributes, too",
          "[decimate]") {
  constexpr double kWeight = 0.3;
  std::array<std::size_t, 2> handed_on{};  // within a chart, along a seam
  for (std::uint32_t seed = 1; seed <= (test::kSanitized ? 2u : 8u); ++seed) {
    IndexedFaceSet mesh = test::icosphere(1);
    Faces before;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const auto face = mesh.face(f);
      const float z = mesh.points[face[0]].z + mesh.points[face[1]].z + mesh.points[face[2]].z;
      before.push_back({{face[0], face[1], face[2]}, z > 0 ? 1u : 0u});
    }
    test::jitter(mesh, 0.05f, seed);
    std::mt19937 random(seed);
    Values values{mesh.points.size(), {0, 0, 1, 1}};  // the range is known
    while (values.all.size() < 4 * mesh.points.size())
      values.all.push_back(static_cast<float>(random() % 1000) / 1000);
    std::vector<std::uint32_t> value_of_corner;
    for (const Face& face : before)
      for (const std::uint32_t v : face.corners)
        value_of_corner.push_back(face.chart * static_cast<std::uint32_t>(values.vertices) + v);
    DVec3 low(mesh.points[0]), high = low;
    for (const Vec3& p : mesh.points)
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], static_cast<double>(p[k]));
        high[k] = std::max(high[k], static_cast<double>(p[k]));
      }
    const double diagonal = length(high - low), cost = kWeight * diagonal * kWeight * diagonal;
    const auto is_parted = [&](std::uint32_t v) {
      const Faces fan = fan_at(before, v);
      return fan.front().chart != fan.back().chart;
    };
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p)
      for (std::uint32_t q = 0; q < p; ++q) {
        DecimateOptions options;
        options.keep_history = true;
        options.bounds.normal_deviation = 3.0;
        options.attributes = {{2, values.all, value_of_corner, kWeight, AttributeKind::kPlain}};
        for (std::uint32_t v = 0; v < mesh.points.size(); ++v)
          if (v != p && v != q) options.locked.vertices.push_back(v);
        const Faces at_p = faces_at(before, p);
        if (is_parted(p) != is_parted(q) ||
            std::none_of(at_p.begin(), at_p.end(), [&](const Face& f) { return f.corners[1] == q; }))
          continue;
        const Decimated d = remove_vertices(mesh, options);
        if (d.history.size() != 2) continue;
        const std::uint32_t first = d.history[0].removed, second = d.history[1].removed;
        Faces between = before;
        std::array<Faces, 2> made;
        for (const auto& change : d.changes.faces) {
          made[change.step].push_back({change.vertices, before[change.wedges[0] / 3].chart});
          if (change.step == 0) between[change.face] = made[0].back();
        }
        for (const std::uint32_t f : d.history[0].faces) between[f].corners.fill(kInvalid);

        double expected = 0, share = 0;  // of the first, which the second gets
        const auto add = [&](const Faces& faces, std::uint32_t v, const std::array<Means, 2>& means,
                             const Faces& filled) {
          const Faces fan = fan_at(faces, v);
          Star star;
          std::vector<std::uint32_t> ring;
          for (const Face& face : fan) {
            if (face.chart != fan.front().chart && star.seam == 0) star.seam = ring.size();
            ring.push_back(face.corners[1]);
            star.ring.push_back(DVec3(mesh.points[ring.back()]) - DVec3(mesh.points[v]));
          }
          Attributes attributes;
          attributes.all = {{cost, {}}, {cost, {}}};
          double weight = 0;
          for (std::size_t side = 0; side < star.sides(); ++side) {
            const std::uint32_t chart = fan[side == 0 ? 0 : star.seam].chart;
            for (std::size_t k = 0; k < 2; ++k) {
              Attribute::OnSide& on = attributes.all[k].side[side];
              for (const std::uint32_t r : ring) on.ring.push_back(values(chart, r, k) - values(chart, v, k));
              on.off = means[chart].value[k] - values(chart, v, k);
              on.gradient = means[chart].gradient[k];
            }
            attributes.weight[side] = means[chart].weight;
            weight += means[chart].weight;
            attributes.left.planes.insert(attributes.left.planes.end(), means[chart].left.begin(),
                                          means[chart].left.end());
          }
          Triangulation triangles;
          const Seen seen(star.up());
          const auto give = [&](std::size_t i, double part) {
            if (v == first && ring[i] == second) share = part;
          };
          for (const Face& face : filled) {
            Triangle t;
            for (std::size_t i = 0; i < 3; ++i)
              t[i] = static_cast<std::size_t>(std::find(ring.begin(), ring.end(), face.corners[i]) -
                                              ring.begin());
            std::sort(t.begin(), t.end());
            triangles.push_back(t);
            std::array<double, 3> part;
            for (std::size_t i = 0; i < 3; ++i)
              part[i] = shadow(DVec3(0.0), seen(star.ring[t[(i + 1) % 3]]), seen(star.ring[t[(i + 2) % 3]]));
            if (star.seam == 0 && *std::min_element(part.begin(), part.end()) >= 0)
              for (std::size_t i = 0; i < 3; ++i) give(t[i], part[i] / (part[0] + part[1] + part[2]));
          }
          if (star.seam > 0) {
            give(0, 1 - star.on_edge().second);
            give(star.seam, star.on_edge().second);
          }
          expected = std::max(expected, error_of(star, attributes, triangles) / weight);
        };
        std::array<Means, 2> gone, rest;
        for (std::uint32_t chart = 0; chart < 2; ++chart) {
          gone[chart] = means_of(mesh, before, values, cost, first, chart);
          rest[chart] = means_of(mesh, before, values, cost, second, chart);
        }
        add(before, first, gone, made[0]);
        for (std::size_t chart = 0; share > 0 && chart < 2; ++chart)
          if (gone[chart].weight > 0)
            absorb(rest[chart], gone[chart], DVec3(mesh.points[first]) - DVec3(mesh.points[second]), share,
                   cost);
        const double of_first = expected;
        add(between, second, rest, made[1]);
        handed_on[is_parted(first) ? 1 : 0] += share > 0.1 && expected > of_first ? 1 : 0;
        INFO("seed " << seed << ", " << first << " and then " << second << ", share " << share);
        CHECK(d.attribute_error == Approx(std::sqrt(expected) / diagonal).epsilon(1e-3));
      }
  }
  CHECK(handed_on[0] > 10);
  CHECK(handed_on[1] > 5);
}

TEST_CASE("decimation: an edge that is barred is not made, and a lane knows nothing of its neighbours",
          "[decimate]") {
  std::mt19937 random(8);
  for (std::size_t n = 4; n <= 9; ++n) {
    std::vector<Star> stars;
    RetriangulationBatch one, other;
    for (std::size_t lane = 0; lane < RetriangulationBatch::kLanes; ++lane) {
      stars.push_back(random_star(n, lane % 3 != 0, random));
      put(stars[lane], lane, one);
      put(stars[lane], RetriangulationBatch::kLanes - 1 - lane, other);
    }
    detail::retriangulate(one, n, -0.99f);
    detail::retriangulate(other, n, -0.99f);
    for (std::size_t lane = 0; lane < RetriangulationBatch::kLanes; ++lane) {
      const std::size_t mirrored = RetriangulationBatch::kLanes - 1 - lane;
      CHECK(one.error[lane] == other.error[mirrored]);
      const Triangulation found = triangulation_in(one, lane, 0, n - 1);
      CHECK(found == triangulation_in(other, mirrored, 0, n - 1));
      for (const auto& [a, b, c] : found)
        if (c > a + 1 && !(a == 0 && c + 1 == n))
          other.barred[RetriangulationBatch::pair(a, c)][mirrored] = HUGE_VALF;
    }
    detail::retriangulate(other, n, -0.99f);
    for (std::size_t lane = 0; lane < RetriangulationBatch::kLanes; ++lane) {
      const std::size_t mirrored = RetriangulationBatch::kLanes - 1 - lane;
      CHECK(other.error[mirrored] >= one.error[lane] * (1 - 1e-5f));
      if (!(other.error[mirrored] < HUGE_VALF)) continue;
      for (const auto& [a, b, c] : triangulation_in(other, mirrored, 0, n - 1))
        CHECK(other.barred[RetriangulationBatch::pair(a, c)][mirrored] == 0);
    }
  }
}

TEST_CASE("decimation: vertex removal makes no edge that is there, and takes the next best", "[decimate]") {
  // A pyramid whose base is bent along the edge from 0 to 2, which lies nearest to its top.
  IndexedFaceSet mesh;
  mesh.points = {{1, 0, 0}, {0, 1, 0.5f}, {-1, 0, 0}, {0, -1, 0.5f}, {0, 0, 0.1f}};
  mesh.corners = {4, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 0, 2, 1, 0, 3, 2};
  DecimateOptions options;
  options.locked.vertices = {0, 1, 2, 3};
  options.bounds.normal_deviation = 1.5;
  const Decimated result = remove_vertices(mesh, options);
  REQUIRE(result.collapses == 1);
  REQUIRE(result.mesh.face_count() == 4);
  std::size_t edges = 0;
  for (std::uint32_t h = 0; h < result.mesh.half_edge_count(); ++h) {
    const std::uint32_t from = result.mesh.origin(HalfEdgeId(h)).index,
                        to = result.mesh.target(HalfEdgeId(h)).index;
    edges += from % 2 == to % 2 ? 1 : 0;
  }
  CHECK(edges == 4);  // each of both edges, from both sides

  // The top lies 0.1 above the edge from 0 to 2, and 0.4 below that from 1 to 3, which counts.
  options.bounds.error = Length::absolute(0.3);
  const Decimated refused = remove_vertices(mesh, options);
  CHECK(refused.collapses == 0);
  CHECK(refused.stop == DecimateStop::kErrorBound);
  options.bounds.error = Length::absolute(0.5);
  CHECK(remove_vertices(mesh, options).collapses == 1);
}

TEST_CASE("decimation: vertex removal keeps the shape of a flat outline with a notch", "[decimate]") {
  // The corner inwards bounds no less than those outwards: filling it would be as wrong as cutting them.
  IndexedFaceSet mesh = test::grid(8, 8);
  IndexedFaceSet notched;
  notched.points = mesh.points;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.face(f);
    if (std::all_of(corners.begin(), corners.end(),
                    [&](std::uint32_t v) { return mesh.points[v].x >= 5 && mesh.points[v].y >= 3; }))
      continue;
    notched.corners.insert(notched.corners.end(), corners.begin(), corners.end());
  }
  DecimateOptions options;
  options.bounds.error = Length::absolute(1e-9);
  const Decimated result = remove_vertices(notched, options);
  CHECK(result.mesh.face_count() == 4);
  CHECK(result.error == 0);
  double area = 0;
  for (std::uint32_t f = 0; f < result.mesh.face_count(); ++f) {
    const auto at = [&](std::uint32_t i) {
      return DVec3(result.positions[result.mesh.origins()[3 * f + i]]);
    };
    area += cross(at(1) - at(0), at(2) - at(0)).z / 2;
  }
  CHECK(area == 64 - 3 * 5);
}

TEST_CASE("decimation: a vertex of many neighbours goes when it has fewer", "[decimate]") {
  // A fan over a square whose sides are cut into eleven.
  IndexedFaceSet mesh;
  constexpr int kSide = 11;
  for (int side = 0; side < 4; ++side)
    for (int i = 0; i < kSide; ++i) {
      const std::array<Vec3, 4> corner = {Vec3(0, 0, 0), Vec3(kSide, 0, 0), Vec3(kSide, kSide, 0),
                                          Vec3(0, kSide, 0)};
      const Vec3 step =
          (corner[static_cast<std::size_t>(side + 1) % 4] - corner[static_cast<std::size_t>(side)]);
      mesh.points.push_back(corner[static_cast<std::size_t>(side)] + step * (static_cast<float>(i) / kSide));
    }
  const auto count = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.emplace_back(4, 5, 0);
  for (std::uint32_t i = 0; i < count; ++i)
    mesh.corners.insert(mesh.corners.end(), {count, i, (i + 1) % count});
  DecimateOptions options;
  options.bounds.error = Length::absolute(1e-6);
  const Decimated result = remove_vertices(mesh, options);
  CHECK(result.mesh.face_count() == 2);
  CHECK(result.source_vertex == std::vector<std::uint32_t>{0, kSide, 2 * kSide, 3 * kSide});
}

TEST_CASE("decimation: vertex removal's history names what went and what stands for it", "[decimate]") {
  IndexedFaceSet mesh = test::torus(24, 16);
  test::jitter(mesh, 0.02f, 3);
  DecimateOptions options;
  options.keep_history = true;
  options.target.faces = 200;
  const Decimated result = remove_vertices(mesh, options);
  REQUIRE(result.history.size() == result.collapses);
  std::vector<std::uint32_t> stands(mesh.points.size());
  std::iota(stands.begin(), stands.end(), 0u);
  std::vector<bool> gone(mesh.face_count(), false);
  for (const Collapse<Vec3>& c : result.history) {
    CHECK(c.position == mesh.points[c.kept]);
    std::replace(stands.begin(), stands.end(), c.removed, c.kept);
    for (const std::uint32_t f : c.faces) {
      CHECK_FALSE(gone[f]);
      gone[f] = true;
    }
  }
  for (std::uint32_t v = 0; v < stands.size(); ++v)
    CHECK(result.source_vertex[result.vertex_map[v]] == stands[v]);
  for (const std::uint32_t f : result.source_face) CHECK_FALSE(gone[f]);
}

}  // namespace vkmesh
