// What the benchmark ran on.
#pragma once

#include <string>

namespace vkmesh::bench {

struct Machine {
  std::string processor;
  unsigned cores = 0;  ///< That this process may use.
  std::string system;  ///< Kernel and architecture.
  std::string compiler;
  std::string build_type;
};

[[nodiscard]] Machine describe_machine();

}  // namespace vkmesh::bench
