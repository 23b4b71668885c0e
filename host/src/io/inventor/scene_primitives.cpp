#include "io/inventor/scene_primitives.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "io/inventor/scene_transform.h"

namespace vkmesh::detail {
namespace {

using glm::dmat3;
using glm::dvec3;

void add_point(ScenePrimitive& to, const dvec3& p) {
  to.points.insert(to.points.end(), {p.x, p.y, p.z});
}

void add_face(ScenePrimitive& to, std::initializer_list<int> corners) {
  to.index.insert(to.index.end(), corners.begin(), corners.end());
  to.index.push_back(-1);
}

/// Points of a circle around the y axis.
void add_ring(ScenePrimitive& to, double radius, double y) {
  for (int i = 0; i < kSceneSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSceneSides;
    add_point(to, {radius * std::sin(angle), y, radius * std::cos(angle)});
  }
}

int next_side(int i) {
  return (i + 1) % kSceneSides;
}

}  // namespace

ScenePrimitive scene_box(const dvec3& size) {
  ScenePrimitive box;
  for (int i = 0; i < 8; ++i)
    add_point(box,
              dvec3((i & 1) != 0 ? 0.5 : -0.5, (i & 2) != 0 ? 0.5 : -0.5, (i & 4) != 0 ? 0.5 : -0.5) * size);
  constexpr int kFaces[6][4] = {{4, 5, 7, 6}, {1, 0, 2, 3}, {5, 1, 3, 7},
                                {0, 4, 6, 2}, {6, 7, 3, 2}, {0, 1, 5, 4}};
  for (const auto& f : kFaces) add_face(box, {f[0], f[1], f[2], f[3]});
  return box;
}

ScenePrimitive scene_sphere(double radius) {
  constexpr int kRings = kSceneSides / 2 - 1;  // Between the poles.
  ScenePrimitive sphere;
  for (int r = 0; r < kRings; ++r) {
    const double angle = std::numbers::pi * (r + 1) / (kRings + 1);
    add_ring(sphere, radius * std::sin(angle), radius * std::cos(angle));
  }
  const int top = kRings * kSceneSides, bottom = top + 1;
  add_point(sphere, {0, radius, 0});
  add_point(sphere, {0, -radius, 0});
  for (int i = 0; i < kSceneSides; ++i) {
    const int j = next_side(i), last = (kRings - 1) * kSceneSides;
    add_face(sphere, {top, i, j});
    for (int r = 0; r + 1 < kRings; ++r) {
      const int upper = r * kSceneSides, lower = upper + kSceneSides;
      add_face(sphere, {upper + i, lower + i, lower + j, upper + j});
    }
    add_face(sphere, {last + i, bottom, last + j});
  }
  return sphere;
}

ScenePrimitive scene_cylinder(double bottom_radius, double top_radius, double height, bool side, bool bottom,
                              bool top) {
  ScenePrimitive cylinder;
  const bool cone = top_radius == 0;
  add_ring(cylinder, bottom_radius, -height / 2);
  if (cone)
    add_point(cylinder, {0, height / 2, 0});
  else
    add_ring(cylinder, top_radius, height / 2);
  for (int i = 0; side && i < kSceneSides; ++i) {
    const int j = next_side(i);
    if (cone)
      add_face(cylinder, {i, j, kSceneSides});
    else
      add_face(cylinder, {i, j, kSceneSides + j, kSceneSides + i});
  }
  const auto add_cap = [&](int first, bool down) {
    for (int i = 0; i < kSceneSides; ++i) cylinder.index.push_back(first + (down ? kSceneSides - 1 - i : i));
    cylinder.index.push_back(-1);
  };
  if (bottom) add_cap(0, true);
  if (top && !cone) add_cap(kSceneSides, false);
  return cylinder;
}

ScenePrimitive scene_elevation_grid(int columns, int rows, double x_spacing, double z_spacing,
                                    std::span<const double> heights) {
  ScenePrimitive grid;
  for (int z = 0; z < rows; ++z)
    for (int x = 0; x < columns; ++x)
      add_point(grid, {x * x_spacing,
                       heights[static_cast<std::size_t>(z) * static_cast<std::size_t>(columns) +
                               static_cast<std::size_t>(x)],
                       z * z_spacing});
  for (int z = 0; z + 1 < rows; ++z)
    for (int x = 0; x + 1 < columns; ++x) {
      const int at = z * columns + x;
      add_face(grid, {at, at + columns, at + columns + 1, at + 1});
    }
  return grid;
}

namespace {

/// The axes of the cross-section's plane at each point of the spine: y along the spine, z towards its inner
/// side (ISO/IEC 14772-1, 6.18.3). Straight stretches take z of their neighbours, a straight spine turns the
/// y axis into its direction.
std::vector<dmat3> spine_frames(const std::vector<dvec3>& spine, bool closed) {
  const auto unit = [](const dvec3& v) {
    const double length = glm::length(v);
    return length > 0 ? v / length : dvec3(0.0);
  };
  const std::size_t n = spine.size();
  std::vector<dvec3> along(n, dvec3(0.0)), inward(n, dvec3(0.0));
  for (std::size_t i = 0; i < n; ++i) {
    // The last point of a closed spine is the first again.
    const std::size_t before = i > 0 ? i - 1 : closed ? n - 2 : i;
    const std::size_t after = i + 1 < n ? i + 1 : closed ? 1 : i;
    along[i] = unit(spine[after] - spine[before]);
    inward[i] = unit(glm::cross(spine[after] - spine[i], spine[before] - spine[i]));
  }
  for (std::size_t i = 1; i < n; ++i) {
    if (along[i] == dvec3(0.0)) along[i] = along[i - 1];
    if (inward[i] == dvec3(0.0)) inward[i] = inward[i - 1];
    if (glm::dot(inward[i], inward[i - 1]) < 0) inward[i] = -inward[i];
  }
  for (std::size_t i = n - 1; i-- > 0;) {
    if (along[i] == dvec3(0.0)) along[i] = along[i + 1];
    if (inward[i] == dvec3(0.0)) inward[i] = inward[i + 1];
  }
  std::vector<dmat3> frames(n, dmat3(1.0));
  for (std::size_t i = 0; i < n; ++i) {
    const dvec3 y = along[i] == dvec3(0.0) ? dvec3(0, 1, 0) : along[i];
    dvec3 z = inward[i] - glm::dot(inward[i], y) * y;
    if (glm::length(z) < 1e-12) {
      // z turned by the least rotation that takes (0, 1, 0) to y.
      const dvec3 up(0, 1, 0), forward(0, 0, 1);
      const double cosine = glm::dot(up, y);
      const dvec3 axis = glm::cross(up, y);
      z = cosine > -1 + 1e-12 ? forward + glm::cross(axis, forward) +
                                    glm::cross(axis, glm::cross(axis, forward)) / (1 + cosine)
                              : forward;
    }
    z = unit(z);
    frames[i] = {glm::cross(y, z), y, z};
  }
  return frames;
}

}  // namespace

ScenePrimitive scene_extrusion(const SceneSweep& sweep) {
  ScenePrimitive out;
  const std::size_t sections = sweep.spine.size();
  if (sections < 2 || sweep.cross_section.size() < 2) return out;
  const bool closed_spine = sections > 2 && sweep.spine.front() == sweep.spine.back();
  const bool closed_section =
      sweep.cross_section.size() > 3 && sweep.cross_section.front() == sweep.cross_section.back();
  const std::size_t width = sweep.cross_section.size() - (closed_section ? 1 : 0);
  const std::vector<dmat3> frames = spine_frames(sweep.spine, closed_spine);
  const auto one_of = [](const auto& values, std::size_t i, const auto& otherwise) {
    return values.empty() ? otherwise : values[std::min(i, values.size() - 1)];
  };
  const std::size_t rings = sections - (closed_spine ? 1 : 0);
  for (std::size_t i = 0; i < rings; ++i) {
    const glm::dvec2 scale = one_of(sweep.scales, i, glm::dvec2(1.0));
    const dmat3 turn(axis_rotation(one_of(sweep.orientations, i, glm::dvec4(0, 0, 1, 0))));
    for (std::size_t k = 0; k < width; ++k) {
      const glm::dvec2 p = sweep.cross_section[k] * scale;
      add_point(out, sweep.spine[i] + frames[i] * (turn * dvec3(p.x, 0, p.y)));
    }
  }
  const auto at = [&](std::size_t ring, std::size_t k) {
    return static_cast<int>(ring % rings * width + k % width);
  };
  for (std::size_t i = 0; i + 1 < sections; ++i)
    for (std::size_t k = 0; k + 1 < width + (closed_section ? 1 : 0); ++k)
      add_face(out, {at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
  const auto add_cap = [&](std::size_t ring, bool begin) {
    for (std::size_t k = 0; k < width; ++k) out.index.push_back(at(ring, begin ? width - 1 - k : k));
    out.index.push_back(-1);
  };
  if (width >= 3 && !closed_spine) {
    if (sweep.begin_cap) add_cap(0, true);
    if (sweep.end_cap) add_cap(rings - 1, false);
  }
  return out;
}

}  // namespace vkmesh::detail
