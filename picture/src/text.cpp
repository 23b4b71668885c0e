#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <ft2build.h>

#include <vkmesh/picture/text.h>
#include FT_FREETYPE_H

#include <vkmesh/base/exceptions_to_result.h>

namespace vkmesh {
namespace {

constexpr char32_t kReplacement = 0xfffd;
constexpr std::string_view kEllipsis = "\xe2\x80\xa6";

/// Takes one character off the front of UTF-8 text that is not empty.
char32_t next_character(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80 ? 1 : first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  char32_t character = length == 1 ? first : first & (0x7fu >> length);
  bool good = length > 0 && first < 0xf5 && length <= text.size();
  for (std::size_t i = 1; good && i < length; ++i) {
    good = (byte(i) & 0xc0u) == 0x80u;
    character = (character << 6) | (byte(i) & 0x3fu);
  }
  // Too long a form, half of a UTF-16 pair, beyond Unicode.
  good = good && !(length == 3 && character < 0x800) && !(length == 4 && character < 0x10000) &&
         !(character >= 0xd800 && character < 0xe000) && character <= 0x10ffff;
  text.remove_prefix(good ? length : 1);
  return good ? character : kReplacement;
}

bool begins_character(char byte) {
  return (static_cast<unsigned char>(byte) & 0xc0u) != 0x80u;
}

std::uint8_t mixed(std::uint8_t under, std::uint8_t over, unsigned cover) {
  return static_cast<std::uint8_t>((under * (255 - cover) + over * cover + 127) / 255);
}

std::string font_file() {
  const char* named = std::getenv("VKMESH_FONT");
  return named != nullptr && *named != '\0' ? named : VKMESH_FONT_FILE;
}

}  // namespace

struct TextFace::Face {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  std::uint32_t size = 0;

  ~Face() {
    if (face != nullptr) FT_Done_Face(face);
    if (library != nullptr) FT_Done_FreeType(library);
  }

  /// Loads the glyphs of the text one after the other, visits each with the place of its pen, and returns
  /// the pen's last place, in 64ths of a pixel.
  template <class Visit>
  std::int64_t set(std::string_view text, FT_Int32 flags, Visit&& visit) {
    std::int64_t pen = 0;
    FT_UInt before = 0;
    while (!text.empty()) {
      const FT_UInt glyph = FT_Get_Char_Index(face, next_character(text));
      FT_Vector kerning = {0, 0};
      if (before != 0 && glyph != 0) FT_Get_Kerning(face, before, glyph, FT_KERNING_UNFITTED, &kerning);
      before = glyph;
      if (FT_Load_Glyph(face, glyph, flags) != 0) continue;
      pen += kerning.x;
      visit(pen);
      pen += face->glyph->advance.x;
    }
    return pen;
  }
};

TextFace::TextFace(std::unique_ptr<Face> face) : face_(std::move(face)) {}
TextFace::TextFace(TextFace&& other) noexcept = default;
TextFace& TextFace::operator=(TextFace&& other) noexcept = default;
TextFace::~TextFace() = default;

Result<TextFace> TextFace::create(std::uint32_t size) {
  return detail::catching([&]() -> Result<TextFace> {
    if (size == 0) return fail(ErrorCode::kUsage, "text needs a size of at least one pixel");
    auto made = std::make_unique<Face>();
    const std::string file = font_file();
    if (FT_Init_FreeType(&made->library) != 0 ||
        FT_New_Face(made->library, file.c_str(), 0, &made->face) != 0 ||
        FT_Set_Pixel_Sizes(made->face, 0, size) != 0)
      return fail(ErrorCode::kUnsuitable,
                  "the font for text in pictures cannot be read; install DejaVu Sans (Debian: "
                  "fonts-dejavu-core) or name a TrueType file in VKMESH_FONT",
                  {file, {}, {}});
    made->size = size;
    return TextFace(std::move(made));
  });
}

void TextFace::draw(Picture& picture, std::int64_t x, std::int64_t y, std::string_view text, Color color) {
  // The base line stands where that of DejaVu Sans leaves as much room above as below.
  const std::int64_t base = y + face_->size;
  face_->set(text, FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT, [&](std::int64_t pen) {
    const FT_GlyphSlot glyph = face_->face->glyph;
    const FT_Bitmap& bitmap = glyph->bitmap;
    if (bitmap.pixel_mode != FT_PIXEL_MODE_GRAY) return;
    const std::int64_t left = x + ((pen + 32) >> 6) + glyph->bitmap_left, top = base - glyph->bitmap_top;
    for (unsigned row = 0; row < bitmap.rows; ++row)
      for (unsigned column = 0; column < bitmap.width; ++column) {
        const std::int64_t px = left + column, py = top + row;
        if (px < 0 || py < 0 || px >= picture.width() || py >= picture.height()) continue;
        const unsigned cover = bitmap.buffer[static_cast<std::ptrdiff_t>(row) * bitmap.pitch +
                                             static_cast<std::ptrdiff_t>(column)];
        Color& pixel = picture.at(static_cast<std::uint32_t>(px), static_cast<std::uint32_t>(py));
        pixel.r = mixed(pixel.r, color.r, cover);
        pixel.g = mixed(pixel.g, color.g, cover);
        pixel.b = mixed(pixel.b, color.b, cover);
      }
  });
}

std::int64_t TextFace::width(std::string_view text) {
  return (face_->set(text, FT_LOAD_TARGET_LIGHT, [](std::int64_t) {}) + 63) >> 6;
}

std::string TextFace::beginning_that_fits(std::string_view text, std::int64_t width) {
  if (this->width(text) <= width) return std::string(text);
  for (std::size_t end = text.size(); end-- > 0;) {
    if (!begins_character(text[end])) continue;
    std::string shorter = std::string(text.substr(0, end)) + std::string(kEllipsis);
    if (this->width(shorter) <= width) return shorter;
  }
  return {};
}

std::string TextFace::end_that_fits(std::string_view text, std::int64_t width) {
  if (this->width(text) <= width) return std::string(text);
  for (std::size_t start = 1; start <= text.size(); ++start) {
    if (start < text.size() && !begins_character(text[start])) continue;
    std::string shorter = std::string(kEllipsis) + std::string(text.substr(start));
    if (this->width(shorter) <= width) return shorter;
  }
  return {};
}

}  // namespace vkmesh
