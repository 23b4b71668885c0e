// The shapes that scenes name instead of giving their points: boxes, spheres, cylinders, cones, height fields
// and sweeps, as polygons (ISO/IEC 14772-1, 6.6, 6.10, 6.13, 6.17, 6.18, 6.42).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace vkmesh::detail {

/// Points of three numbers, and faces as lists of points that -1 ends, counter-clockwise from outside.
struct ScenePrimitive {
  std::vector<double> points;
  std::vector<std::int32_t> index;
};

/// How many sides round shapes get.
inline constexpr int kSceneSides = 32;

[[nodiscard]] ScenePrimitive scene_box(const glm::dvec3& size);
/// Meridians meet in one point at each pole, on the y axis.
[[nodiscard]] ScenePrimitive scene_sphere(double radius);
/// Around the y axis, from -height / 2 to height / 2; a radius of 0 at the top makes a cone.
[[nodiscard]] ScenePrimitive scene_cylinder(double bottom_radius, double top_radius, double height, bool side,
                                            bool bottom, bool top);
/// `heights` of columns × rows points, row after row along x, the rows along z.
[[nodiscard]] ScenePrimitive scene_elevation_grid(int columns, int rows, double x_spacing, double z_spacing,
                                                  std::span<const double> heights);

struct SceneSweep {
  std::vector<glm::dvec2> cross_section;
  std::vector<glm::dvec3> spine;
  std::vector<glm::dvec2> scales;        ///< One, or one for each point of the spine.
  std::vector<glm::dvec4> orientations;  ///< Axes and angles; one, or one for each point of the spine.
  bool begin_cap = true, end_cap = true;
};
/// The cross-section moved along the spine. Where the section or the spine is closed the surface is, too.
[[nodiscard]] ScenePrimitive scene_extrusion(const SceneSweep& sweep);

}  // namespace vkmesh::detail
