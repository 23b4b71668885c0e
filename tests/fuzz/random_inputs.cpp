// Runs a fuzz target without a fuzzer: random_inputs COUNT gives it random bytes so many times, the same each
// time.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
  const long count = argc == 2 ? std::atol(argv[1]) : 0;
  if (count <= 0) {
    std::fprintf(stderr, "usage: %s COUNT\n", argv[0]);
    return 2;
  }
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(count); ++seed) {
    std::fprintf(stderr, "\rseed %u ", seed);  // the last one is what broke something
    std::mt19937 random(seed);
    std::vector<std::uint8_t> bytes(20 + random() % 500);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::fprintf(stderr, "\n");
  return 0;
}
