// What the commands that decimate are told alike, and the surface that they work on.
#pragma once

#include <chrono>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/indexed_face_set.h>

#include "commands/simplify/simplify_attributes.h"
#include "commands/simplify/simplify_criteria.h"
#include "job/common.h"

namespace vkmesh::cli {

/// How to remove, and what stays: all but where to stop.
struct DecimationChoice {
  std::string operation = "edge-collapse";
  std::string boundary = "in-shape";
  std::optional<double> crease_angle, prune_size, prune_relative_size;
  AttributeChoice attributes;
  bool force_target = false;
  double max_normal_deviation = DecimateBounds{}.normal_deviation * kDegrees;
  std::shared_ptr<SimplifyCriteria> criteria = std::make_shared<SimplifyCriteria>();

  [[nodiscard]] bool points_stay() const { return operation != "edge-collapse"; }
};

/// The options that fill `choice`, which they keep alive.
void add_decimation_options(CLI::App& command, const std::shared_ptr<DecimationChoice>& choice);

/// The vertices of a file that are kept as they are, while the surface that they make is connected and
/// mended: each corner goes on naming its vertex.
struct VertexBuffer {
  std::vector<Vec3> points;
  std::vector<Channel> channels;
};

/// A surface that is read, connected and cut into triangles, with its attributes.
class DecimationInput {
 public:
  /// Reads the input of the job. `keep_buffer`: its vertices are kept, and corners that are of different ones
  /// are told apart.
  static Result<DecimationInput> read(Job& job, const DecimationChoice& choice, bool keep_buffer);

  /// What the choice says, with attributes and locks, which are borrowed from this.
  [[nodiscard]] DecimateOptions options() const;
  /// What is left of a time limit that counts from when the input had been read.
  [[nodiscard]] std::optional<double> seconds_left(const std::optional<double>& limit) const;

  HalfEdgeMesh half_edges;
  std::vector<Vec3> points;
  SimplifyAttributes attributes;
  VertexBuffer buffer;
  std::vector<std::uint32_t> vertex_of_corner;  ///< In the buffer.

 private:
  std::chrono::steady_clock::time_point read_;
  DecimateOptions chosen_;
};

/// Why a removal is illegal, in words.
struct ReasonText {
  Reason reason;
  const char* name;  // in JSON
  const char* text;
};
inline constexpr ReasonText kReasonTexts[] = {{Reason::kLinkCondition, "link", "the manifold would break"},
                                              {Reason::kFoldOver, "fold_over", "a face would fold over"},
                                              {Reason::kErrorBound, "error", "the error is too large"},
                                              {Reason::kLocked, "locked", "locked"},
                                              {Reason::kBoundary, "boundary", "of the boundary"},
                                              {Reason::kSeam, "seam", "a seam would break"},
                                              {Reason::kCriterion, "criterion", "a bound forbids it"}};
static_assert(std::size(kReasonTexts) == kReasons.size());

/// "12 (a face would fold over), …", the most first.
[[nodiscard]] std::string describe(const CountByReason& counts);

/// Points that no face uses, which a decimation does not know.
[[nodiscard]] std::vector<std::uint32_t> isolated_points(const HalfEdgeMesh& mesh, std::size_t points);

}  // namespace vkmesh::cli
