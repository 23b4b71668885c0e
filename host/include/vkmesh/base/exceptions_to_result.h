// Keeps exceptions of the standard library inside the library.
#pragma once

#include <exception>
#include <new>
#include <string>
#include <utility>

#include <vkmesh/base/result.h>

namespace vkmesh::detail {

/// Runs `body`, which returns a Result, and turns what it throws into an Error.
template <class Body>
auto catching(Body&& body) -> decltype(body()) {
  try {
    return std::forward<Body>(body)();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kOutOfMemory, "host memory ran out");
  } catch (const std::exception& e) {
    return fail(ErrorCode::kInternal, std::string("unexpected exception: ") + e.what());
  }
}

}  // namespace vkmesh::detail
