// Output that appears whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>

namespace vkmesh {

/// Writes a file that appears under its name when all bytes are written, and not at all otherwise. A path
/// that names no regular file (a device, a pipe, "-" for standard output) is written directly. Errors:
/// kNotWritable, kOutOfMemory.
[[nodiscard]] VKMESH_API Result<void> write_file(const std::filesystem::path& path,
                                                 std::span<const std::byte> bytes);

}  // namespace vkmesh
