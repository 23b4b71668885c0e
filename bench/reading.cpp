// Reading PLY from files: vkmesh, and the plain copy of a file's bytes into memory that none can be faster
// than.
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <vkmesh/io/mesh_io.h>
#include <vkmesh/repair/consolidate.h>

#include "bench/contestants.h"

namespace vkmesh::bench {
namespace {

/// Reads a file as `cat` into memory would: one block of its size, filled by read(). It is in the page cache.
Result<double> copy_file(const std::filesystem::path& path, std::size_t size) {
  const Stopwatch watch;
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return fail(ErrorCode::kUnreadable, "cannot be opened", {path.string(), {}, {}});
  const std::unique_ptr<char, decltype(&std::free)> bytes(static_cast<char*>(std::malloc(size)), std::free);
  std::size_t total = 0;
  for (ssize_t got = 1;
       bytes != nullptr && got > 0 && total<size; total += got> 0 ? static_cast<std::size_t>(got) : 0)
    got = ::read(file, bytes.get() + total, size - total);
  ::close(file);
  const double milliseconds = watch.milliseconds();
  if (total != size) return fail(ErrorCode::kUnreadable, "cannot be read whole", {path.string(), {}, {}});
  return milliseconds;
}

Result<double> read_file(const std::filesystem::path& path, bool and_join) {
  const Stopwatch watch;
  VKMESH_TRY(const MeshFile file, read_mesh(path));
  double milliseconds = watch.milliseconds();
  if (and_join) {
    VKMESH_TRY(const HalfEdgeMesh made, to_half_edge_mesh(std::get<IndexedFaceSet>(file.geometry)));
    milliseconds = watch.milliseconds();
  }
  return milliseconds;
}

}  // namespace

Result<ReadingFiles> ReadingFiles::write(const IndexedFaceSet& mesh) {
  std::string name = (std::filesystem::temp_directory_path() / "vkmesh-bench-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    return fail(ErrorCode::kNotWritable, "no temporary folder", {name, {}, {}});
  ReadingFiles files;
  files.folder_ = name;
  for (const auto& [encoding, step] : {std::pair{FileEncoding::kAscii, step::kReadAscii},
                                       std::pair{FileEncoding::kBinaryLittleEndian, step::kReadBinary}}) {
    WriteOptions options;
    options.encoding = encoding;
    const std::filesystem::path path = files.folder_ / (name_of(encoding) + ".ply");
    VKMESH_CHECK(write_mesh(path, {mesh.points, mesh.corners, mesh.face_offsets, {}, {}, {}}, options));
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (error) return fail(ErrorCode::kUnreadable, error.message(), {path.string(), {}, {}});
    files.all_.push_back({step, path, static_cast<std::size_t>(size)});
  }
  return files;
}

ReadingFiles::ReadingFiles(ReadingFiles&& other) noexcept
    : folder_(std::exchange(other.folder_, {})), all_(std::move(other.all_)) {}

ReadingFiles::~ReadingFiles() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

void add_reading(Programme& programme, const ReadingFiles& files) {
  for (const ReadingFiles::File& file : files.all()) {
    const auto add = [&](const std::string& name, std::function<Result<double>()> run) {
      programme.contestants.push_back({file.step, name, std::move(run), {}, false, file.size});
    };
    add("vkmesh, CPU", [&file] { return read_file(file.path, false); });
    add("vkmesh, CPU, with half-edges", [&file] { return read_file(file.path, true); });
    add("plain copy of the bytes", [&file] { return copy_file(file.path, file.size); });
  }
}

}  // namespace vkmesh::bench
