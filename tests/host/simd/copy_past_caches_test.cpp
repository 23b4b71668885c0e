// Copies past the caches.
#include "simd/copy_past_caches.h"

#include <vector>

#include <catch2/catch.hpp>

TEST_CASE("a copy past the caches copies what it is asked to and nothing else, wherever that begins") {
  std::vector<float> from(80);
  for (std::size_t i = 0; i < from.size(); ++i) from[i] = static_cast<float>(i + 1);
  for (std::size_t begin = 0; begin < 20; ++begin)
    for (std::size_t count = 0; count < 40; ++count) {
      std::vector<float> to(from.size(), 0.0f), expected = to;
      for (std::size_t i = 0; i < count; ++i) expected[begin + i] = from[7 + i];
      vkmesh::detail::copy_past_caches(&from[7], count, &to[begin]);
      CHECK(to == expected);
    }
}
