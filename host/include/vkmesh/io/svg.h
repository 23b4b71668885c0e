// Writing pictures of the plane as SVG.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/predicates.h>

namespace vkmesh {

struct SvgCircle {
  DVec2 centre{0.0};
  double radius = 0;
};

/// What is drawn: polygons, then circles, then dots.
struct SvgPicture {
  std::span<const DVec2> points;
  /// Point of every corner, polygon after polygon.
  std::span<const std::uint32_t> corners;
  /// Empty: all polygons are triangles. Else polygon i has the corners [offsets[i], offsets[i + 1]).
  std::span<const std::uint32_t> face_offsets;
  /// Empty: polygons are not filled. Else red, green and blue of each.
  std::span<const std::uint8_t> fills;
  std::span<const SvgCircle> circles;
  std::span<const DVec2> dots;
  DVec2 offset{0.0};    ///< Added to all coordinates.
  std::string comment;  ///< What made it; empty for none.
};

/// Writes a picture as SVG 1.1, 800 pixels on its longer side. It shows the bounds of the points and the
/// dots, with a margin; y points up. Coordinates stand in the file as they are, in the fewest digits that are
/// read as the same numbers. The file appears whole or not at all; "-" is standard output. O(corners).
/// Errors: kUsage for an index out of range; kUnsuitable for coordinates that are not finite, and for no
/// points and no dots; kNotWritable; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<void> write_svg(const std::filesystem::path& path, const SvgPicture& picture);

}  // namespace vkmesh
