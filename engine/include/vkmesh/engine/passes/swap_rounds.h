// Edge swaps in rounds on a device.
#pragma once

#include <cstdint>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/device_array.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/passes/swap_rounds.h>

namespace vkmesh {

/// Connectivity that rounds change, and their scratch. Kept from frame to frame it costs no allocation.
struct DeviceSwapRounds {
  DeviceArray<std::uint32_t> corners, twins;  ///< One a half-edge, as HalfEdgeMesh::origins() and twins().
  DeviceArray<std::uint32_t> leading;         ///< One a vertex: on the boundary the half-edge without a twin.
  /// Edges with a word that is not 0 at one of their half-edges stay. Set by the caller before the first
  /// round, one a half-edge, or left empty.
  DeviceArray<std::uint32_t> locked;
  DeviceArray<std::uint32_t> sources;  ///< As SwapRounds::source_corner.
  DeviceArray<std::uint32_t> swaps;    ///< In each round that has run.
  DeviceArray<float> gains;
  DeviceArray<std::uint32_t> best, changed, selected, counts;
  std::uint32_t rounds = 0;  ///< Recorded so far.
};

/// Records so many more rounds of vkmesh::swap_rounds(), equal to it bit for bit: the first call copies the
/// connectivity of the mesh, later ones go on. `max_rounds`: of all calls, room for swaps. Rounds that find
/// nothing to swap change nothing. Errors: kUsage for more rounds, or `locked` of another size; kOutOfMemory;
/// kNoDevice.
[[nodiscard]] VKMESH_API Result<void> record_swap_rounds(Recorder& recorder, DeviceMesh& mesh,
                                                         DeviceSwapRounds& state, std::uint32_t rounds,
                                                         std::uint32_t max_rounds,
                                                         SwapCriterion criterion = SwapCriterion::kMinAngle);

/// Rounds that run_swap_rounds() does at most.
inline constexpr std::uint32_t kMaxDeviceSwapRounds = 4096;

/// Runs rounds until one swaps nothing, a few at a time, and downloads the result: vkmesh::swap_rounds() on a
/// device, in at most kMaxDeviceSwapRounds rounds.
/// Errors: as that and record_swap_rounds().
[[nodiscard]] VKMESH_API Result<SwapRounds> run_swap_rounds(Context& context, DeviceMesh& mesh,
                                                            const SwapRoundsOptions& options = {},
                                                            const Progress& progress = {});

}  // namespace vkmesh
