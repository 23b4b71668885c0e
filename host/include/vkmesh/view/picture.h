// A picture in host memory: pixels and rectangles. Text and PNG: the library vkmesh::picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>

namespace vkmesh {

/// sRGB, 8 bits a component, not premultiplied.
struct Color {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;

  friend bool operator==(const Color&, const Color&) = default;
};

/// "#rrggbb", "#rgb", "white" or "black". Errors: kUsage.
[[nodiscard]] VKMESH_API Result<Color> parse_color(std::string_view text);

/// Rows from top to bottom, pixels from left to right.
class VKMESH_API Picture {
 public:
  Picture() = default;
  /// Errors: kUsage for more than kMaxPictureSide a side; kOutOfMemory.
  [[nodiscard]] static Result<Picture> create(std::uint32_t width, std::uint32_t height, Color fill);

  [[nodiscard]] std::uint32_t width() const { return width_; }
  [[nodiscard]] std::uint32_t height() const { return height_; }
  /// O(1). x < width(), y < height().
  [[nodiscard]] Color& at(std::uint32_t x, std::uint32_t y) { return pixels_[std::size_t{y} * width_ + x]; }
  [[nodiscard]] const Color& at(std::uint32_t x, std::uint32_t y) const {
    return pixels_[std::size_t{y} * width_ + x];
  }
  [[nodiscard]] std::span<Color> pixels() { return pixels_; }
  [[nodiscard]] std::span<const Color> pixels() const { return pixels_; }

 private:
  std::uint32_t width_ = 0, height_ = 0;
  std::vector<Color> pixels_;
};

/// Pixels a side that PNG readers commonly take.
inline constexpr std::uint32_t kMaxPictureSide = 1000000;

// What lies outside of the picture is cut off. O(pixels touched).
VKMESH_API void fill_rectangle(Picture& picture, std::int64_t x, std::int64_t y, std::int64_t width,
                               std::int64_t height, Color color);
/// Copies `from` with its top left corner to (x, y).
VKMESH_API void paste(Picture& picture, const Picture& from, std::int64_t x, std::int64_t y);

}  // namespace vkmesh
