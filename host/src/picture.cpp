#include <algorithm>
#include <charconv>
#include <cstring>

#include <png.h>
#include <stb/stb_easy_font.h>

#include <vkmesh/picture.h>

#include "catching.h"
#include "io/bytes.h"

namespace vkmesh {
namespace {

static_assert(sizeof(Color) == 4, "pixels are packed as libpng's RGBA");

/// Lines of the face are 12 of its pixels apart; capitals are 7 high, and descenders reach 2 below.
constexpr std::int64_t kLineHeight = 11;

std::string printable(std::string_view text) {
  std::string result;
  for (const char c : text) {
    // One '?' for each character of UTF-8, not for each byte.
    if ((static_cast<unsigned char>(c) & 0xc0u) == 0x80u) continue;
    result.push_back(c >= ' ' && c <= '~' ? c : '?');
  }
  return result;
}

}  // namespace

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

void draw_text(Picture& picture, std::int64_t x, std::int64_t y, std::string_view text, Color color,
               std::uint32_t scale) {
  std::string line = printable(text);
  // Four corners of 16 bytes for each stroke; no character has more than 13 strokes.
  std::vector<std::byte> strokes(line.size() * 16 * 64);
  const int count =
      stb_easy_font_print(0.0f, 0.0f, line.data(), nullptr, strokes.data(), static_cast<int>(strokes.size()));
  const auto corner = [&](int stroke, int i) {
    float xy[2];
    std::memcpy(xy, strokes.data() + (std::size_t{64} * static_cast<std::size_t>(stroke)) + 16 * i,
                sizeof xy);
    return std::pair{static_cast<std::int64_t>(xy[0]), static_cast<std::int64_t>(xy[1])};
  };
  for (int i = 0; i < count; ++i) {
    const auto [left, top] = corner(i, 0);
    const auto [right, bottom] = corner(i, 2);
    fill_rectangle(picture, x + left * scale, y + top * scale, (right - left) * scale, (bottom - top) * scale,
                   color);
  }
}

std::int64_t text_width(std::string_view text, std::uint32_t scale) {
  std::string line = printable(text);
  return std::int64_t{stb_easy_font_width(line.data())} * scale;
}

std::int64_t text_height(std::uint32_t scale) {
  return kLineHeight * scale;
}

std::string text_that_fits(std::string_view text, std::int64_t width, std::uint32_t scale) {
  if (text_width(text, scale) <= width) return std::string(text);
  for (std::size_t start = 1; start < text.size(); ++start) {
    std::string shorter = "..." + std::string(text.substr(start));
    if (text_width(shorter, scale) <= width) return shorter;
  }
  return {};
}

// The simplified interface of libpng is used: it returns its errors, where the full one jumps over C++
// frames.
Result<std::vector<std::byte>> encode_png(const Picture& picture) {
  return detail::catching([&]() -> Result<std::vector<std::byte>> {
    if (picture.pixels().empty()) return fail(ErrorCode::kUsage, "a picture without pixels");
    std::vector<std::uint8_t> rgb;
    rgb.reserve(3 * picture.pixels().size());
    for (const Color& c : picture.pixels()) rgb.insert(rgb.end(), {c.r, c.g, c.b});
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = picture.width();
    image.height = picture.height();
    image.format = PNG_FORMAT_RGB;
    std::vector<std::byte> bytes(PNG_IMAGE_PNG_SIZE_MAX(image));
    png_alloc_size_t size = bytes.size();
    if (png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb.data(), 0, nullptr) == 0)
      return fail(ErrorCode::kInternal, std::string("libpng: ") + image.message);
    bytes.resize(size);
    return bytes;
  });
}

Result<Picture> decode_png(std::span<const std::byte> bytes) {
  return detail::catching([&]() -> Result<Picture> {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0)
      return fail(ErrorCode::kUnreadable, std::string("no PNG: ") + image.message);
    image.format = PNG_FORMAT_RGBA;
    auto picture = Picture::create(image.width, image.height, {});
    if (!picture) {
      png_image_free(&image);
      return picture;
    }
    if (png_image_finish_read(&image, nullptr, picture->pixels().data(), 0, nullptr) == 0)
      return fail(ErrorCode::kUnreadable, std::string("a damaged PNG: ") + image.message);
    return picture;
  });
}

Result<void> write_png(const std::filesystem::path& path, const Picture& picture) {
  return detail::catching([&]() -> Result<void> {
    VKMESH_TRY(const std::vector<std::byte> bytes, encode_png(picture));
    VKMESH_TRY(detail::OutputFile file, detail::OutputFile::open(path));
    detail::Output output(file.file(), path.string(), false);
    output.put({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    VKMESH_CHECK(output.finish());
    return file.commit();
  });
}

}  // namespace vkmesh
