// How subcommands tell of the angles of triangles.
#pragma once

#include <cstddef>
#include <string>

#include <vkmesh/analysis/triangle_angles.h>

#include "job/common.h"

namespace vkmesh::cli {

[[nodiscard]] Json json_of(const TriangleAngles& angles);
/// `faces`: how many triangles.
[[nodiscard]] std::string text_of(const TriangleAngles& angles, std::size_t faces);

}  // namespace vkmesh::cli
