// Bytes from files and into them: gzip both ways, standard streams, and output that appears whole or not at
// all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <zlib.h>

#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>

namespace vkmesh::detail {

/// Bytes on the heap that grow without being copied twice or cleared first.
class ByteBuffer {
 public:
  [[nodiscard]] std::string_view view() const { return {data_.get(), size_}; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Room for `more` bytes behind the content; throws std::bad_alloc.
  char* room(std::size_t more);
  /// Takes over `count` of the bytes that room() gave.
  void advance(std::size_t count) { size_ += count; }

 private:
  struct Free {
    void operator()(char* p) const { std::free(p); }
  };
  std::unique_ptr<char, Free> data_;
  std::size_t size_ = 0, capacity_ = 0;
};

/// What a file held, inflated where it was gzipped.
struct Content {
  ByteBuffer bytes;
  bool gzip = false;
};

[[nodiscard]] bool is_gzip(std::string_view bytes);

/// The whole content of a file; "-" is standard input. The compressed bytes of a gzipped file are never held
/// at once. Errors: kUnreadable (with the system's reason, or the byte at which a gzip stream breaks),
/// kInterrupted.
[[nodiscard]] Result<Content> read_content(const std::filesystem::path& path, const Progress& progress);

/// Inflates all members of a gzip stream. Errors: kUnreadable.
[[nodiscard]] Result<ByteBuffer> inflate_bytes(std::string_view compressed, const std::string& name);

/// Where encoders put their bytes: buffered, through gzip when asked for, then into memory or a file. The
/// first error sticks, and finish() tells it.
class Output {
 public:
  /// Into memory.
  Output(std::vector<std::byte>& memory, bool gzip);
  /// Into an open file, which stays the caller's; `name` is for messages.
  Output(int file, std::string name, bool gzip);
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  ~Output();

  /// Room for `count` bytes (at most kRoom) at the end of what was put; commit() takes over those used.
  char* room(std::size_t count) {
    if (buffer_.size() - used_ < count) flush();
    return buffer_.data() + used_;
  }
  void commit(const char* end) { used_ = static_cast<std::size_t>(end - buffer_.data()); }
  void put(std::string_view bytes);

  /// Passes everything on and ends the gzip stream.
  [[nodiscard]] Result<void> finish();

  static constexpr std::size_t kRoom = 4096;

 private:
  Output(std::vector<std::byte>* memory, int file, std::string name, bool gzip);
  void flush();
  void deflate_buffer(int mode);
  void pass_on(const char* bytes, std::size_t count);

  std::vector<char> buffer_;
  std::size_t used_ = 0;
  std::vector<std::byte>* memory_ = nullptr;
  int file_ = -1;
  std::string name_;
  std::optional<z_stream> deflater_;
  std::vector<char> deflated_;
  std::optional<Error> error_;
};

/// A file to write that appears under its name when commit() succeeds, and not at all otherwise. What is no
/// regular file ("-", a device, a pipe) is written directly.
class OutputFile {
 public:
  [[nodiscard]] static Result<OutputFile> open(const std::filesystem::path& path);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  [[nodiscard]] int file() const { return file_; }
  [[nodiscard]] Result<void> commit();

 private:
  OutputFile() = default;

  int file_ = -1;
  std::string name_;                 ///< As the caller wrote it.
  std::filesystem::path target_;     ///< Symbolic links resolved.
  std::filesystem::path temporary_;  ///< Empty when written directly.
};

}  // namespace vkmesh::detail
