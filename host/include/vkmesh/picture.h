// A picture in host memory: pixels, rectangles, text, and PNG.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <vkmesh/result.h>

namespace vkmesh {

/// sRGB, 8 bits a component, not premultiplied.
struct Color {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;

  friend bool operator==(const Color&, const Color&) = default;
};

/// "#rrggbb", "#rgb", "white" or "black". Errors: kUsage.
[[nodiscard]] Result<Color> parse_color(std::string_view text);

/// Rows from top to bottom, pixels from left to right.
class Picture {
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
void fill_rectangle(Picture& picture, std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height,
                    Color color);
/// Copies `from` with its top left corner to (x, y).
void paste(Picture& picture, const Picture& from, std::int64_t x, std::int64_t y);

/// One line in a small sans-serif face of printable ASCII; any other character is shown as '?'. (x, y) is the
/// top left corner; `scale` pixels for each of the face's.
void draw_text(Picture& picture, std::int64_t x, std::int64_t y, std::string_view text, Color color,
               std::uint32_t scale = 1);
[[nodiscard]] std::int64_t text_width(std::string_view text, std::uint32_t scale = 1);
/// Of a line, with what reaches below the base line.
[[nodiscard]] std::int64_t text_height(std::uint32_t scale = 1);
/// The text itself where it fits into `width` pixels, else its end behind "...": of a path the name matters.
[[nodiscard]] std::string text_that_fits(std::string_view text, std::int64_t width, std::uint32_t scale = 1);

/// An RGB PNG of the picture; what is transparent keeps its colour. The same bytes for the same picture.
/// Errors: kUsage for a picture without pixels; kOutOfMemory.
[[nodiscard]] Result<std::vector<std::byte>> encode_png(const Picture& picture);
/// Any PNG as 8-bit sRGB. Errors: kUnreadable, kOutOfMemory.
[[nodiscard]] Result<Picture> decode_png(std::span<const std::byte> bytes);

/// The file appears whole or not at all; "-" is standard output. Errors: as encode_png(); kNotWritable.
[[nodiscard]] Result<void> write_png(const std::filesystem::path& path, const Picture& picture);

}  // namespace vkmesh
