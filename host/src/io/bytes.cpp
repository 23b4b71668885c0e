#include "io/bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <system_error>
#include <utility>

namespace vkmesh::detail {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 20;

std::string reason(int code) { return std::generic_category().message(code); }

/// Closes what it holds.
class Descriptor {
 public:
  explicit Descriptor(int file) : file_(file) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (file_ > 2) ::close(file_);
  }
  [[nodiscard]] int get() const { return file_; }

 private:
  int file_;
};

/// Inflates a stream of gzip members that comes in pieces.
class Inflater {
 public:
  explicit Inflater(std::string name) : name_(std::move(name)) {
    if (inflateInit2(&stream_, 15 + 16) != Z_OK) throw std::bad_alloc();
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  Result<void> feed(std::string_view compressed, ByteBuffer& out) {
    while (!compressed.empty()) {
      if (ended_) {
        // Between members. Padding with zeros after the last one is what tape and block devices leave.
        const std::size_t zeros = std::min(compressed.find_first_not_of('\0'), compressed.size());
        padded_ = padded_ || zeros > 0;
        consumed_ += zeros;
        compressed.remove_prefix(zeros);
        if (compressed.empty()) break;
        if (padded_) return broken("bytes that are not gzip follow the compressed data");
        inflateReset(&stream_);
        ended_ = false;
      }
      const auto piece = static_cast<uInt>(std::min(compressed.size(), kChunk));
      const std::size_t space = std::clamp(out.size() / 4, std::size_t{1} << 16, kChunk << 5);
      stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
      stream_.avail_in = piece;
      stream_.next_out = reinterpret_cast<Bytef*>(out.room(space));
      stream_.avail_out = static_cast<uInt>(space);
      const int status = inflate(&stream_, Z_NO_FLUSH);
      out.advance(space - stream_.avail_out);
      const std::size_t eaten = piece - stream_.avail_in;
      consumed_ += eaten;
      compressed.remove_prefix(eaten);
      if (status == Z_MEM_ERROR) throw std::bad_alloc();
      if (status == Z_STREAM_END) {
        ended_ = true;
        ++members_;
      } else if (status != Z_OK && !(status == Z_BUF_ERROR && stream_.avail_out == 0)) {
        return broken(members_ > 0 && stream_.total_in < 10
                          ? "bytes that are not gzip follow the compressed data"
                          : std::string("the gzip stream is damaged") +
                                (stream_.msg != nullptr ? std::string(" (") + stream_.msg + ")" : ""));
      }
    }
    return {};
  }

  /// After the last piece. Output that did not fit is drained by feed(), which asks for more room while input is left;
  /// what is left inside zlib then is an unfinished member.
  Result<void> finish() const {
    if (!ended_) return broken("the gzip stream is cut short");
    return {};
  }

 private:
  tl::unexpected<Error> broken(std::string message) const {
    return fail(ErrorCode::kUnreadable, std::move(message), {name_, {}, consumed_});
  }

  z_stream stream_{};
  std::string name_;
  std::uint64_t consumed_ = 0;
  std::size_t members_ = 0;
  bool ended_ = false;
  bool padded_ = false;
};

}  // namespace

char* ByteBuffer::room(std::size_t more) {
  if (capacity_ - size_ < more) {
    const std::size_t wanted = std::max(size_ + more, size_ + size_ / 2);
    // Not new[]: realloc moves pages of a large block instead of copying them, so the peak stays at one block.
    char* grown = static_cast<char*>(std::realloc(data_.get(), wanted));
    if (grown == nullptr) throw std::bad_alloc();
    static_cast<void>(data_.release());
    data_.reset(grown);
    capacity_ = wanted;
  }
  return data_.get() + size_;
}

bool is_gzip(std::string_view bytes) { return bytes.substr(0, 2) == "\x1f\x8b"; }

Result<ByteBuffer> inflate_bytes(std::string_view compressed, const std::string& name) {
  ByteBuffer out;
  Inflater inflater(name);
  VKMESH_CHECK(inflater.feed(compressed, out));
  VKMESH_CHECK(inflater.finish());
  return out;
}

Result<Content> read_content(const std::filesystem::path& path, const Progress& progress) {
  const bool standard_input = path == "-";
  const std::string name = standard_input ? "standard input" : path.string();
  const auto unreadable = [&](int code) {
    return fail(ErrorCode::kUnreadable, "cannot be read: " + reason(code), {name, {}, {}});
  };
  const Descriptor file(standard_input ? 0 : ::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) return unreadable(errno);
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) return unreadable(errno);
  if (S_ISDIR(info.st_mode)) return unreadable(EISDIR);
  // A hint: a file may grow or shrink while it is read.
  const std::size_t expected = S_ISREG(info.st_mode) ? static_cast<std::size_t>(info.st_size) : 0;

  Content content;
  std::optional<Inflater> inflater;
  ByteBuffer piece;
  bool first = true;
  for (std::size_t total = 0;;) {
    // One byte more than expected, so that the end of the file shows without another allocation.
    const std::size_t want =
        first || inflater ? kChunk
                          : std::max(kChunk, expected > total ? expected - total + 1 : content.bytes.size() / 4);
    ByteBuffer& into = inflater ? piece : content.bytes;
    char* room = inflater && piece.size() > 0 ? nullptr : into.room(want);
    const ssize_t got = ::read(file.get(), room, want);
    if (got < 0) {
      if (errno == EINTR) continue;
      return unreadable(errno);
    }
    if (got == 0) break;
    const auto count = static_cast<std::size_t>(got);
    total += count;
    if (first && is_gzip({room, count})) {
      content.gzip = true;
      inflater.emplace(name);
      piece = std::exchange(content.bytes, {});
      VKMESH_CHECK(inflater->feed({room, count}, content.bytes));
    } else if (inflater) {
      VKMESH_CHECK(inflater->feed({room, count}, content.bytes));
    } else {
      into.advance(count);
    }
    first = false;
    if (progress && expected > 0 &&
        !progress(0.5 * std::min(1.0, static_cast<double>(total) / static_cast<double>(expected))))
      return fail(ErrorCode::kInterrupted, "reading was interrupted", {name, {}, {}});
  }
  if (inflater) VKMESH_CHECK(inflater->finish());
  return content;
}

Output::Output(std::vector<std::byte>& memory, bool gzip) : buffer_(kChunk), memory_(&memory) {
  if (gzip) {
    deflater_.emplace();
    if (deflateInit2(&*deflater_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
      deflater_.reset();
      throw std::bad_alloc();
    }
    deflated_.resize(kChunk);
  }
}

Output::Output(int file, std::string name, bool gzip) : Output(*static_cast<std::vector<std::byte>*>(nullptr), gzip) {
  file_ = file;
  name_ = std::move(name);
}
