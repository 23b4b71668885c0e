#include <algorithm>
#include <charconv>
#include <string>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/view/picture.h>

namespace vkmesh {

Result<Color> parse_color(std::string_view text) {
  if (text == "white") return Color{255, 255, 255, 255};
  if (text == "black") return Color{0, 0, 0, 255};
  const std::string_view digits = text.substr(text.starts_with('#') ? 1 : 0);
  unsigned value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (error != std::errc{} || end != digits.data() + digits.size() ||
      (digits.size() != 6 && digits.size() != 3))
    return fail(ErrorCode::kUsage,
                "'" + std::string(text) + "' is no colour: write #rrggbb, #rgb, white or black");
  if (digits.size() == 3)
    value = ((value >> 8) & 15u) * 0x110000u + ((value >> 4) & 15u) * 0x1100u + (value & 15u) * 0x11u;
  return Color{static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>((value >> 8) & 255u),
               static_cast<std::uint8_t>(value & 255u), 255};
}

Result<Picture> Picture::create(std::uint32_t width, std::uint32_t height, Color fill) {
  return detail::catching([&]() -> Result<Picture> {
    if (width > kMaxPictureSide || height > kMaxPictureSide)
      return fail(ErrorCode::kUsage, "a picture of " + std::to_string(width) + " by " +
                                         std::to_string(height) + " pixels: at most " +
                                         std::to_string(kMaxPictureSide) + " a side are possible");
    Picture picture;
    picture.width_ = width;
    picture.height_ = height;
    picture.pixels_.assign(std::size_t{width} * height, fill);
    return picture;
  });
}

void fill_rectangle(Picture& picture, std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height,
                    Color color) {
  const std::int64_t right = std::min<std::int64_t>(x + width, picture.width());
  const std::int64_t bottom = std::min<std::int64_t>(y + height, picture.height());
  for (std::int64_t row = std::max<std::int64_t>(y, 0); row < bottom; ++row)
    for (std::int64_t column = std::max<std::int64_t>(x, 0); column < right; ++column)
      picture.at(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row)) = color;
}

void paste(Picture& picture, const Picture& from, std::int64_t x, std::int64_t y) {
  for (std::uint32_t row = 0; row < from.height(); ++row)
    for (std::uint32_t column = 0; column < from.width(); ++column) {
      const std::int64_t to_x = x + column, to_y = y + row;
      if (to_x >= 0 && to_y >= 0 && to_x < picture.width() && to_y < picture.height())
        picture.at(static_cast<std::uint32_t>(to_x), static_cast<std::uint32_t>(to_y)) = from.at(column, row);
    }
}

}  // namespace vkmesh
