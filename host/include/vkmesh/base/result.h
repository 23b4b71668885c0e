// Errors as values: what every fallible function of vkmesh returns.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <tl/expected.hpp>

#include <vkmesh/base/api.h>

namespace vkmesh {

/// What went wrong, coarsely. The values are the exit codes of the command line and do not change.
enum class ErrorCode : int {
  kInternal = 1,      ///< A broken promise of the library itself.
  kUsage = 2,         ///< An argument outside its documented range.
  kUnreadable = 3,    ///< Input that cannot be read, or is malformed.
  kUnsuitable = 4,    ///< A well-formed mesh that this operation cannot take.
  kNoDevice = 5,      ///< No Vulkan device answers the request, or it was lost.
  kOutOfMemory = 6,   ///< Host or device memory ran out; the caller's data is as it was.
  kNotWritable = 7,   ///< Output that cannot be written.
  kInterrupted = 130  ///< A progress callback asked to stop.
};

/// Where an error lies. Each part is optional; `line` counts from 1, `byte` from 0.
struct Location {
  std::string file;
  std::optional<std::uint64_t> line;
  std::optional<std::uint64_t> byte;
};

/// One failure: a code for programs, one sentence for people, and the place.
struct VKMESH_API Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
  Location where;

  /// "file:12: message", "file: byte 80: message" or just "message".
  [[nodiscard]] std::string describe() const;
};

template <class T>
using Result = tl::expected<T, Error>;

/// Shorthand for the failing side of a Result.
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message, Location where = {}) {
  return tl::unexpected<Error>(Error{code, std::move(message), std::move(where)});
}

}  // namespace vkmesh

#define VKMESH_JOIN_INNER(a, b) a##b
#define VKMESH_JOIN(a, b) VKMESH_JOIN_INNER(a, b)

/// `VKMESH_TRY(auto x, f());` binds the value of f(), or returns its error from the enclosing function.
#define VKMESH_TRY(declaration, expression)                                                             \
  auto VKMESH_JOIN(vkmesh_result_, __LINE__) = (expression);                                            \
  if (!VKMESH_JOIN(vkmesh_result_, __LINE__))                                                           \
    return ::tl::unexpected<::vkmesh::Error>(std::move(VKMESH_JOIN(vkmesh_result_, __LINE__)).error()); \
  declaration = *std::move(VKMESH_JOIN(vkmesh_result_, __LINE__))

/// `VKMESH_CHECK(f());` returns the error of a Result<void>, if there is one.
#define VKMESH_CHECK(expression)                                                                    \
  do {                                                                                              \
    auto vkmesh_status = (expression);                                                              \
    if (!vkmesh_status) return ::tl::unexpected<::vkmesh::Error>(std::move(vkmesh_status).error()); \
  } while (false)
