#include "io/bytes.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace vkmesh::detail {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 20;   // Read from a file at once.
constexpr std::size_t kBuffer = std::size_t{1} << 18;  // Collected before it is written.

std::string reason(int code) {
  return std::generic_category().message(code);
}

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
      if (status == Z_STREAM_END)
        ended_ = true;
      else if (status != Z_OK && status != Z_BUF_ERROR)
        return broken(std::string("the gzip stream is damaged") +
                      (stream_.msg != nullptr ? std::string(" (") + stream_.msg + ")" : ""));
    }
    return {};
  }

  /// After the last piece. Output that did not fit is drained by feed(), which asks for more room while input
  /// is left; what is left inside zlib then is an unfinished member.
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
  bool ended_ = false;
  bool padded_ = false;
};

}  // namespace

char* ByteBuffer::room(std::size_t more) {
  if (capacity_ - size_ < more) {
    const std::size_t wanted = std::max(size_ + more, size_ + size_ / 2);
    // Not new[]: realloc moves pages of a large block instead of copying them, so the peak stays at one
    // block.
    char* grown = static_cast<char*>(std::realloc(data_.get(), wanted));
    if (grown == nullptr) throw std::bad_alloc();
    static_cast<void>(data_.release());
    data_.reset(grown);
    capacity_ = wanted;
  }
  return data_.get() + size_;
}

bool is_gzip(std::string_view bytes) {
  return bytes.substr(0, 2) == "\x1f\x8b";
}

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
  // Room for all of it, so that nothing moves; memory is taken only where bytes are put. One byte more than
  // expected, so that the end of the file shows without another allocation.
  if (expected > 0) content.bytes.room(expected + 1);
  std::optional<Inflater> inflater;
  ByteBuffer piece;  // Compressed bytes, one piece at a time.
  std::size_t total = 0;
  for (bool first = true;; first = false) {
    ByteBuffer& into = inflater ? piece : content.bytes;
    const std::size_t want =
        first || inflater ? kChunk : std::max(kChunk, expected > total ? expected - total + 1 : total / 4);
    char* room = into.room(want);
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
      std::swap(piece, content.bytes);
    }
    if (inflater)
      VKMESH_CHECK(inflater->feed({room, count}, content.bytes));
    else
      into.advance(count);
    if (progress && expected > 0 &&
        !progress(0.5 * std::min(1.0, static_cast<double>(total) / static_cast<double>(expected))))
      return fail(ErrorCode::kInterrupted, "reading was interrupted", {name, {}, {}});
  }
  if (inflater) VKMESH_CHECK(inflater->finish());
  return content;
}

Output::Output(std::vector<std::byte>* memory, int file, std::string name, bool gzip)
    : buffer_(kBuffer), memory_(memory), file_(file), name_(std::move(name)) {
  if (!gzip) return;
  deflated_.resize(kBuffer);
  deflater_.emplace();
  if (deflateInit2(&*deflater_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
}

Output::Output(std::vector<std::byte>& memory, bool gzip) : Output(&memory, -1, {}, gzip) {}

Output::Output(int file, std::string name, bool gzip) : Output(nullptr, file, std::move(name), gzip) {}

Output::~Output() {
  if (deflater_) deflateEnd(&*deflater_);
}

void Output::put(std::string_view bytes) {
  while (!bytes.empty()) {
    if (used_ == buffer_.size()) flush();
    const std::size_t count = std::min(bytes.size(), buffer_.size() - used_);
    std::memcpy(buffer_.data() + used_, bytes.data(), count);
    used_ += count;
    bytes.remove_prefix(count);
  }
}

Result<void> Output::finish() {
  flush();
  if (deflater_) deflate_buffer(Z_FINISH);
  if (error_) return tl::unexpected<Error>(*error_);
  return {};
}

void Output::flush() {
  if (deflater_)
    deflate_buffer(Z_NO_FLUSH);
  else
    pass_on(buffer_.data(), used_);
  used_ = 0;
}

void Output::deflate_buffer(int mode) {
  deflater_->next_in = reinterpret_cast<Bytef*>(buffer_.data());
  deflater_->avail_in = static_cast<uInt>(used_);
  int status = Z_OK;
  do {
    deflater_->next_out = reinterpret_cast<Bytef*>(deflated_.data());
    deflater_->avail_out = static_cast<uInt>(deflated_.size());
    status = deflate(&*deflater_, mode);
    pass_on(deflated_.data(), deflated_.size() - deflater_->avail_out);
  } while (deflater_->avail_out == 0 && status != Z_STREAM_END);
}

void Output::pass_on(const char* bytes, std::size_t count) {
  if (error_) return;
  if (memory_ != nullptr) {
    const auto* from = reinterpret_cast<const std::byte*>(bytes);
    memory_->insert(memory_->end(), from, from + count);
    return;
  }
  while (count > 0) {
    const ssize_t written = ::write(file_, bytes, count);
    if (written < 0) {
      if (errno == EINTR) continue;
      error_ = Error{ErrorCode::kNotWritable, "cannot be written: " + reason(errno), {name_, {}, {}}};
      return;
    }
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
}

Result<OutputFile> OutputFile::open(const std::filesystem::path& path) {
  OutputFile out;
  out.name_ = path == "-" ? "standard output" : path.string();
  const auto not_writable = [&](int code) {
    return fail(ErrorCode::kNotWritable, "cannot be written: " + reason(code), {out.name_, {}, {}});
  };
  if (path == "-") {
    out.file_ = 1;
    return out;
  }
  struct stat info {};
  const bool exists = ::stat(path.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) return not_writable(EISDIR);
  if (exists && ::access(path.c_str(), W_OK) != 0) return not_writable(errno);
  if (exists && !S_ISREG(info.st_mode)) {
    out.file_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (out.file_ < 0) return not_writable(errno);
    return out;
  }
  std::error_code error;
  out.target_ = exists ? std::filesystem::canonical(path, error) : path;
  if (error) return not_writable(error.value());
  const std::filesystem::path folder = out.target_.parent_path();
  for (unsigned attempt = 0; out.file_ < 0; ++attempt) {
    const std::string temporary =
        ".vkmesh-" + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".tmp";
    out.temporary_ = folder / temporary;
    out.file_ = ::open(out.temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (out.file_ < 0 && errno != EEXIST) {
      const int code = errno;
      out.temporary_.clear();
      return not_writable(code);
    }
  }
  // A file that is replaced keeps its permissions; where that fails the new file has the usual ones.
  if (exists) static_cast<void>(::fchmod(out.file_, info.st_mode & 07777));
  return out;
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : file_(std::exchange(other.file_, -1)),
      name_(std::move(other.name_)),
      target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})) {}

OutputFile::~OutputFile() {
  if (file_ > 2) ::close(file_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

Result<void> OutputFile::commit() {
  const auto not_writable = [&](int code) {
    return fail(ErrorCode::kNotWritable, "cannot be written: " + reason(code), {name_, {}, {}});
  };
  // Some file systems tell only now that there was no room.
  if (file_ > 2 && ::close(std::exchange(file_, -1)) != 0) return not_writable(errno);
  if (temporary_.empty()) return {};
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) return not_writable(errno);
  temporary_.clear();
  return {};
}

}  // namespace vkmesh::detail
