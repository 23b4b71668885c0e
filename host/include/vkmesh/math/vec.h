// The vector types of vkmesh: GLM's packed ones, also in programs whose own are aligned
// (GLM_FORCE_DEFAULT_ALIGNED_GENTYPES).
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace vkmesh {

using Vec2 = glm::vec<2, float, glm::packed_highp>;
using Vec3 = glm::vec<3, float, glm::packed_highp>;
using Vec4 = glm::vec<4, float, glm::packed_highp>;
using DVec3 = glm::vec<3, double, glm::packed_highp>;

static_assert(sizeof(Vec3) == 12, "positions are packed: three floats, no padding");

}  // namespace vkmesh
