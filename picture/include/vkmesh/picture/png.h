// Pictures as PNG.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/view/picture.h>

namespace vkmesh {

/// An RGB PNG of the picture; what is transparent keeps its colour. The same bytes for the same picture.
/// Errors: kUsage for a picture without pixels; kOutOfMemory.
[[nodiscard]] VKMESH_API Result<std::vector<std::byte>> encode_png(const Picture& picture);
/// Any PNG as 8-bit sRGB. Errors: kUnreadable, kOutOfMemory.
[[nodiscard]] VKMESH_API Result<Picture> decode_png(std::span<const std::byte> bytes);

/// The file appears whole or not at all; "-" is standard output. Errors: as encode_png(); kNotWritable.
[[nodiscard]] VKMESH_API Result<void> write_png(const std::filesystem::path& path, const Picture& picture);

}  // namespace vkmesh
