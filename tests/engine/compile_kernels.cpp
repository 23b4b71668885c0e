// Makes every embedded kernel on a device and runs none: for drivers that compile for hardware which is not
// there. fused_multiply_adds.cmake reads the machine code that the driver prints.
//   vkmesh_compile_kernels DEVICE [contractible]     "contractible": without the decoration NoContraction
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <span>
#include <vector>

#include <vkmesh/engine/core/context.h>
#include <vkmesh/engine/core/kernel.h>

#include "core/spirv.h"
#include "shaders.h"

namespace {

std::vector<std::uint32_t> contractible(std::span<const std::uint32_t> module) {
  constexpr std::uint16_t kOpDecorate = 71;
  constexpr std::uint32_t kNoContraction = 42;
  std::vector<std::uint32_t> kept(module.begin(), module.begin() + 5);
  for (const auto& i : *vkmesh::detail::spirv_instructions(module))
    if (i.opcode != kOpDecorate || i.words[2] != kNoContraction)
      kept.insert(kept.end(), i.words.begin(), i.words.end());
  return kept;
}

int fail(const vkmesh::Error& error) {
  std::fprintf(stderr, "compile_kernels: %s\n", error.describe().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const bool change = argc > 2 && std::strcmp(argv[2], "contractible") == 0;
  vkmesh::ContextOptions options;
  options.device = argv[1];
  options.skip_exactness_check = true;
  const auto context = vkmesh::Context::create(options);
  if (!context) return fail(context.error());
  std::printf("device: %s, %s\n", (*context)->info().name.c_str(), (*context)->info().driver.c_str());
  std::vector<std::vector<std::uint32_t>> changed;  // A context keeps the address of what it made kernels of.
  for (vkmesh::KernelSource source : vkmesh::shaders::kernels()) {
    if (change) source.spirv = changed.emplace_back(contractible(source.spirv));
    const auto kernel = vkmesh::Kernel::get(**context, source);
    if (!kernel) return fail(kernel.error());
  }
  std::printf("kernels: %zu\n", vkmesh::shaders::kernels().size());
  return 0;
}
