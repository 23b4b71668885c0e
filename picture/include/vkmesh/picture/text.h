// Text in pictures: DejaVu Sans, set by FreeType.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/view/picture.h>

namespace vkmesh {

/// The height of a line of text of that size, with what reaches above and below and the room to the next
/// line. It does not depend on the face, so that places can be planned without one.
[[nodiscard]] constexpr std::int64_t line_height(std::uint32_t size) {
  return (std::int64_t{5} * size + 3) / 4;
}

/// A face at one size. Move-only. One thread at a time may use it; several faces may be used at once.
class VKMESH_API TextFace {
 public:
  /// `size` is the em in pixels, at least 1. The face is the TrueType file that the environment variable
  /// VKMESH_FONT names, else DejaVu Sans where the build found it. Errors: kUsage for a size of 0;
  /// kUnsuitable, with what to do, where there is no such file or FreeType cannot read it; kOutOfMemory.
  [[nodiscard]] static Result<TextFace> create(std::uint32_t size);
  TextFace(TextFace&& other) noexcept;
  TextFace& operator=(TextFace&& other) noexcept;
  ~TextFace();

  /// Draws one line of UTF-8, anti-aliased over what is there. (x, y) is the top left corner of a line of
  /// line_height(); what lies outside of the picture is cut off. Bytes that are no UTF-8 and characters that
  /// the face lacks are drawn as its replacement. O(pixels touched).
  void draw(Picture& picture, std::int64_t x, std::int64_t y, std::string_view text, Color color);
  /// Pixels that the line takes from left to right.
  [[nodiscard]] std::int64_t width(std::string_view text);
  /// The text itself where it fits into `width` pixels, else its beginning and an ellipsis; empty where that
  /// does not fit either.
  [[nodiscard]] std::string beginning_that_fits(std::string_view text, std::int64_t width);
  /// The same with the end of the text behind an ellipsis: of a path the name matters.
  [[nodiscard]] std::string end_that_fits(std::string_view text, std::int64_t width);

 private:
  struct Face;
  explicit TextFace(std::unique_ptr<Face> face);
  std::unique_ptr<Face> face_;
};

}  // namespace vkmesh
