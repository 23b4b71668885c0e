#include "bench/machine.h"

#include <fstream>
#include <string>

#include <sched.h>
#include <sys/utsname.h>

namespace vkmesh::bench {
namespace {

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string compiler_name() {
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return "g++ " __VERSION__;
#else
  return "unknown";
#endif
}

}  // namespace

Machine describe_machine() {
  Machine machine;
  machine.processor = processor_name();
  cpu_set_t cores;
  CPU_ZERO(&cores);
  if (sched_getaffinity(0, sizeof cores, &cores) == 0)
    machine.cores = static_cast<unsigned>(CPU_COUNT(&cores));
  utsname names{};
  if (uname(&names) == 0)
    machine.system = std::string(names.sysname) + " " + names.release + " " + names.machine;
  machine.compiler = compiler_name();
  machine.build_type = VKMESH_BUILD_TYPE;
  return machine;
}

}  // namespace vkmesh::bench
