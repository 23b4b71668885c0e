// Runs a fuzz target without a fuzzer: random_inputs COUNT [FIRST] gives it random bytes so many times, of
// the seeds from FIRST on.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
  const long count = argc >= 2 ? std::atol(argv[1]) : 0;
  const long first = argc == 3 ? std::atol(argv[2]) : 0;
  if (count <= 0 || first < 0 || argc > 3) {
    std::fprintf(stderr, "usage: %s COUNT [FIRST]\n", argv[0]);
    return 2;
  }
  const auto end = static_cast<std::uint32_t>(first + count);
  for (auto seed = static_cast<std::uint32_t>(first); seed < end; ++seed) {
    std::fprintf(stderr, "\rseed %u ", seed);  // the last one is what broke something
    std::mt19937 random(seed);
    std::vector<std::uint8_t> bytes(20 + random() % 500);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::fprintf(stderr, "\n");
  return 0;
}
