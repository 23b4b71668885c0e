// The one source of the wrapping library that sees the newer header. Nothing else of it is exported.
#include "bench/newer_meshoptimizer.h"

#include <meshoptimizer.h>

#define VKMESH_EXPORTED __attribute__((visibility("default")))

VKMESH_EXPORTED int vkmesh_newer_meshopt_version() {
  return MESHOPTIMIZER_VERSION;
}

VKMESH_EXPORTED std::size_t vkmesh_newer_meshopt_simplify(unsigned* destination, const unsigned* indices,
                                                          std::size_t index_count, const float* positions,
                                                          std::size_t vertex_count, std::size_t stride,
                                                          std::size_t target_index_count, float target_error,
                                                          unsigned options, float* result_error) {
  return meshopt_simplify(destination, indices, index_count, positions, vertex_count, stride,
                          target_index_count, target_error, options, result_error);
}

VKMESH_EXPORTED std::size_t vkmesh_newer_meshopt_simplify_with_update(
    unsigned* indices, std::size_t index_count, float* positions, std::size_t vertex_count,
    std::size_t stride, std::size_t target_index_count, float target_error) {
  return meshopt_simplifyWithUpdate(indices, index_count, positions, vertex_count, stride, nullptr, 0,
                                    nullptr, 0, nullptr, target_index_count, target_error, 0, nullptr);
}
