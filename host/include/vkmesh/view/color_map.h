// Colours for numbers: perceptually uniform maps, robust ranges, and the ticks of a legend.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/view/picture.h>

namespace vkmesh {

enum class ColorMap {
  kSequential,   ///< Dark violet over blue-green to light yellow: lightness rises evenly.
  kDiverging,    ///< Blue over near-white to red, lightness symmetric: for signed values.
  kCategorical,  ///< Neighbouring entries differ in hue: for numbers that name things.
};

using ColorTable = std::array<Color, 256>;

/// The colours of a map for 0, 1/255, ..., 1. The paths are drawn in Oklab (B. Ottosson, "A perceptual color
/// space for image processing", 2020), chroma lessened where sRGB ends. O(1).
[[nodiscard]] VKMESH_API ColorTable color_table(ColorMap map);

struct ValueRange {
  double low = 0, high = 1;
};

/// The values below which `fraction` and 1 - `fraction` of the finite ones lie, so that a few outliers do not
/// flatten the rest; the extremes where these coincide. [0, 1] without finite values. O(values).
[[nodiscard]] VKMESH_API ValueRange robust_range(std::span<const float> values, double fraction);

/// Round numbers (1, 2 or 5 times a power of ten apart) inside the range, at most `most` of them (2 or more),
/// in ascending order.
[[nodiscard]] VKMESH_API std::vector<double> round_ticks(const ValueRange& range, std::size_t most);

}  // namespace vkmesh
