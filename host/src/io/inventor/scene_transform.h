// Transforms as Inventor and VRML nodes give them.
#pragma once

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <vkmesh/base/result.h>

#include "io/inventor/scene_graph.h"

namespace vkmesh::detail {

/// A rotation by an axis and an angle in radians; an axis of no length turns nothing.
inline glm::dmat4 axis_rotation(const glm::dvec4& r) {
  const glm::dvec3 axis(r);
  if (axis == glm::dvec3(0.0) || r.w == 0) return glm::dmat4(1.0);
  return glm::rotate(glm::dmat4(1.0), r.w, axis);
}

/// The fields of both formats' Transform node, applied to columns: scale along the turned axes, rotate and
/// translate, the first two about the centre. `scale` is the name of the field of scale factors.
inline Result<glm::dmat4> transform_of(SceneNumbers& numbers, const SceneNode& node, const char* scale) {
  glm::dvec3 translation(0.0), center(0.0), factors(1.0);
  glm::dvec4 rotation(0, 0, 1, 0), orientation(0, 0, 1, 0);
  VKMESH_CHECK(numbers.values(node.field("translation"), {&translation.x, 3}));
  VKMESH_CHECK(numbers.values(node.field("rotation"), {&rotation.x, 4}));
  VKMESH_CHECK(numbers.values(node.field(scale), {&factors.x, 3}));
  VKMESH_CHECK(numbers.values(node.field("scaleOrientation"), {&orientation.x, 4}));
  VKMESH_CHECK(numbers.values(node.field("center"), {&center.x, 3}));
  const glm::dmat4 one(1.0);
  const glm::dmat4 turned = axis_rotation(orientation);
  return glm::translate(one, translation) * glm::translate(one, center) * axis_rotation(rotation) * turned *
         glm::scale(one, factors) * glm::transpose(turned) * glm::translate(one, -center);
}

/// True when every element is a number.
inline bool is_finite(const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(m[column][row])) return false;
  return true;
}

}  // namespace vkmesh::detail
