// A meshoptimizer newer than the installed one, under names of its own: both are in one program.
#pragma once

#include <cstddef>

extern "C" {
/// MESHOPTIMIZER_VERSION.
int vkmesh_newer_meshopt_version();
/// meshopt_simplify.
std::size_t vkmesh_newer_meshopt_simplify(unsigned* destination, const unsigned* indices,
                                          std::size_t index_count, const float* positions,
                                          std::size_t vertex_count, std::size_t stride,
                                          std::size_t target_index_count, float target_error,
                                          unsigned options, float* result_error);
/// meshopt_simplifyWithUpdate without attributes, locks or options.
std::size_t vkmesh_newer_meshopt_simplify_with_update(unsigned* indices, std::size_t index_count,
                                                      float* positions, std::size_t vertex_count,
                                                      std::size_t stride, std::size_t target_index_count,
                                                      float target_error);
}
