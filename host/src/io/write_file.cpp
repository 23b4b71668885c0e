#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/io/write_file.h>

#include "io/bytes.h"

namespace vkmesh {

Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  return detail::catching([&]() -> Result<void> {
    VKMESH_TRY(detail::OutputFile file, detail::OutputFile::open(path));
    detail::Output output(file.file(), path.string(), false);
    output.put({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    VKMESH_CHECK(output.finish());
    return file.commit();
  });
}

}  // namespace vkmesh
