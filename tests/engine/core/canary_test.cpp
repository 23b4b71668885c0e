#include <catch2/catch.hpp>

#include "core/device.h"
#include "support/device.h"

namespace vkmesh {

namespace detail {
/// See canary_of_fast_math.cpp.
Result<void> check_exactness_with_fast_math(Context& context);
}  // namespace detail

namespace test {

TEST_CASE("a build that changes arithmetic is told from a device that does") {
  CHECK(detail::check_exactness(test_context()));
#ifndef VKMESH_ADDRESS_SANITIZER  // whose build is clang's with little optimisation: it changes nothing there
  const auto checked = detail::check_exactness_with_fast_math(test_context());
  REQUIRE(!checked);
  CHECK(checked.error().code == ErrorCode::kInternal);
  CHECK_THAT(checked.error().message, Catch::Contains("compiled with options that change arithmetic"));
#endif
  // Its copies of inline functions have not taken the place of the exact ones.
  CHECK(detail::check_exactness(test_context()));
}

}  // namespace test
}  // namespace vkmesh
