// Text in pictures.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <vkmesh/base/api.h>
#include <vkmesh/view/picture.h>

namespace vkmesh {

/// One line in a small sans-serif face of printable ASCII; any other character is shown as '?'. (x, y) is the
/// top left corner; `scale` pixels for each of the face's.
VKMESH_API void draw_text(Picture& picture, std::int64_t x, std::int64_t y, std::string_view text,
                          Color color, std::uint32_t scale = 1);
[[nodiscard]] VKMESH_API std::int64_t text_width(std::string_view text, std::uint32_t scale = 1);
/// The height of a line, with what reaches below the base line.
[[nodiscard]] VKMESH_API std::int64_t text_height(std::uint32_t scale = 1);
/// The text itself where it fits into `width` pixels, else its end behind "...": of a path the name matters.
[[nodiscard]] VKMESH_API std::string text_that_fits(std::string_view text, std::int64_t width,
                                                    std::uint32_t scale = 1);

}  // namespace vkmesh
