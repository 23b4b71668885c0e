#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include <stb/stb_easy_font.h>

#include <vkmesh/picture/text.h>

namespace vkmesh {
namespace {

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

}  // namespace vkmesh
