// What every fuzz target says when a property does not hold.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

namespace vkmesh::fuzz {

/// Stops the program, so that the fuzzer keeps the input, unless `holds`.
inline void require(bool holds, const std::string& property) {
  if (holds) return;
  std::fprintf(stderr, "broken property: %s\n", property.c_str());
  std::abort();
}

}  // namespace vkmesh::fuzz
