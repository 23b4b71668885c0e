// Does the device compute what the host computes?
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include <vkmesh/engine/core/dispatch.h>
#include <vkmesh/math/arithmetic.h>

#include "core/canary_params.h"
#include "core/device.h"
#include "shaders.h"

namespace vkmesh::detail {
namespace {

constexpr std::uint32_t kCases = 512;
static_assert((kCases - 1) * std::uint64_t{VKMESH_CANARY_UINT_STEP} < std::uint64_t{1} << 31);

/// What each result of shaders/core/canary.comp is.
constexpr std::array<const char*, VKMESH_CANARY_RESULTS> kNames = {
    "zero_below",     "reciprocal",  "reciprocal_root", "root",          "first_quadrant_angle",
    "squared_length", "area_vector", "area_vector",     "area_vector",   "unit_vector",
    "unit_vector",    "unit_vector", "angle_between",   "a + b * c",     "reciprocal",
    "float of uint",  "arccosine",   "exponential",     "vector_length", "cotangent",
    "corner_angle",   "cube_root",   "dihedral_angle"};

/// Values of either sign and of every magnitude in [2^-60, 2^50), some equal, some one bit apart.
std::vector<float> make_inputs() {
  std::vector<float> inputs(kCases * VKMESH_CANARY_INPUTS);
  std::uint32_t state = 1;
  const auto random = [&] {
    state = state * 1664525u + 1013904223u;
    return state >> 8;
  };
  for (std::uint32_t i = 0; i < kCases; ++i) {
    // Every other case has its values close together, as the corners of a triangle are.
    const std::uint32_t exponent = 127 - 60 + random() % 110;
    for (std::uint32_t k = 0; k < VKMESH_CANARY_INPUTS; ++k) {
      const std::uint32_t own = i % 2 == 0 ? exponent : 127 - 60 + random() % 110;
      const std::uint32_t bits = (random() % 2) << 31 | own << 23 | (random() & 0x7fffffu);
      inputs[i * VKMESH_CANARY_INPUTS + k] = std::bit_cast<float>(bits);
    }
    if (i % 16 == 0) inputs[i * VKMESH_CANARY_INPUTS + 3] = inputs[i * VKMESH_CANARY_INPUTS];
    if (i % 32 == 0)
      inputs[i * VKMESH_CANARY_INPUTS + 4] = std::nextafter(inputs[i * VKMESH_CANARY_INPUTS + 1], 0.0f);
  }
  return inputs;
}

std::array<float, VKMESH_CANARY_RESULTS> expected(const float* in, std::uint32_t i) {
  const Vec3 a(in[0], in[1], in[2]), b(in[3], in[4], in[5]), c(in[6], in[7], in[8]);
  const float x = std::fabs(a.x), y = std::fabs(a.y);
  const Vec3 area = area_vector(a, b, c), unit = unit_vector(a);
  const float twice_area = vector_length(area), product = corner_product(a, b, c);
  return {zero_below(a.x, y),
          exact::reciprocal(x),
          exact::reciprocal_root(x),
          exact::root(y),
          exact::first_quadrant_angle(y, x),
          squared_length(b),
          area.x,
          area.y,
          area.z,
          unit.x,
          unit.y,
          unit.z,
          angle_between(unit, unit_vector(b)),
          c.x + c.y * (b.x - c.x),
          exact::reciprocal(static_cast<float>(i + 1)),
          static_cast<float>(i * VKMESH_CANARY_UINT_STEP),
          exact::arccosine(unit.x),
          exact::exponential(a.y),
          vector_length(b),
          cotangent(product, twice_area),
          corner_angle(product, twice_area),
          exact::cube_root(y),
          dihedral_angle(unit, unit_vector(b), c)};
}

/// FNV-1a (G. Fowler, L. C. Noll, K.-P. Vo) of all that is expected.
std::uint64_t digest_of_expected(const std::vector<float>& inputs) {
  std::uint64_t digest = 0xcbf29ce484222325u;
  for (std::uint32_t i = 0; i < kCases; ++i)
    for (const float value : expected(inputs.data() + i * VKMESH_CANARY_INPUTS, i))
      digest = (digest ^ std::bit_cast<std::uint32_t>(value)) * 0x100000001b3u;
  return digest;
}

/// What digest_of_expected() is where the host computes as it should.
constexpr std::uint64_t kExpectedDigest = 0xea7aaea19bca5411u;

std::string hexadecimal(float value) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%08x", static_cast<unsigned>(std::bit_cast<std::uint32_t>(value)));
  return text.data();
}

}  // namespace

Result<void> check_exactness(Context& context) {
  DeviceArray<float> input_array, result_array;
  const std::vector<float> inputs = make_inputs();
  VKMESH_CHECK(input_array.upload(context, inputs, "canary inputs"));
  VKMESH_TRY(Recorder recorder, Recorder::create(context));
  using P = kernels::CanaryParams;
  VKMESH_CHECK(Dispatch<P>(recorder, shaders::canary, kCases)
                   .read(&P::inputs, input_array)
                   .write(&P::results, result_array, kCases * VKMESH_CANARY_RESULTS)
                   .record());
  VKMESH_CHECK(recorder.submit_and_wait());
  VKMESH_TRY(const std::vector<float> results, result_array.download());

  for (std::uint32_t i = 0; i < kCases; ++i) {
    const auto wanted = expected(inputs.data() + i * VKMESH_CANARY_INPUTS, i);
    for (std::uint32_t k = 0; k < VKMESH_CANARY_RESULTS; ++k) {
      const float got = results[i * VKMESH_CANARY_RESULTS + k];
      if (std::bit_cast<std::uint32_t>(got) == std::bit_cast<std::uint32_t>(wanted[k])) continue;
      if (digest_of_expected(inputs) != kExpectedDigest)
        return fail(ErrorCode::kInternal,
                    "vkmesh was compiled with options that change arithmetic, such as -ffast-math: it cannot "
                    "tell whether " +
                        context.info().name + " computes as it should");
      return fail(ErrorCode::kNoDevice, context.info().name + " computes " + kNames[k] +
                                            " otherwise than the host: " + hexadecimal(got) + " instead of " +
                                            hexadecimal(wanted[k]) + " in case " + std::to_string(i));
    }
  }
  return {};
}

}  // namespace vkmesh::detail
