// Keeps exceptions of the standard library inside the library.
#pragma once

#include <exception>
#include <new>
#include <string>
#include <utility>

#include <vkmesh/base/result.h>

namespace vkmesh::detail {

/// Runs `body`, which returns a Result, and turns what it throws into an Error. The library is compiled with
/// exceptions. In programs that are not, what headers compile there has none to catch: the standard library
/// ends the program where memory runs out.
template <class Body>
auto catching(Body&& body) -> decltype(body()) {
#if defined(__cpp_exceptions)
  try {
    return std::forward<Body>(body)();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kOutOfMemory, "host memory ran out");
  } catch (const std::exception& e) {
    return fail(ErrorCode::kInternal, std::string("unexpected exception: ") + e.what());
  }
#else
  return std::forward<Body>(body)();
#endif
}

}  // namespace vkmesh::detail
