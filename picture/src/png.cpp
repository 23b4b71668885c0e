#include <cstdint>
#include <string>

#include <png.h>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/io/write_file.h>
#include <vkmesh/picture/png.h>

namespace vkmesh {

static_assert(sizeof(Color) == 4, "pixels are packed as libpng's RGBA");

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
  VKMESH_TRY(const std::vector<std::byte> bytes, encode_png(picture));
  return write_file(path, bytes);
}

}  // namespace vkmesh
