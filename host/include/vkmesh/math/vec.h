// The vector types of vkmesh: GLM's.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace vkmesh {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using DVec3 = glm::dvec3;

static_assert(sizeof(Vec3) == 12, "positions are packed: three floats, no padding");

}  // namespace vkmesh
