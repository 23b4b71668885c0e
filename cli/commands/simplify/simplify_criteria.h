// The criteria of a decimation beside its quadric error.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <vkmesh/decimation/decimate.h>

#include "job/common.h"

namespace vkmesh::cli {

/// What was given on the command line.
class SimplifyCriteria {
 public:
  /// Errors: kUsage, for a name or a weight that is none.
  [[nodiscard]] Result<DecimateWeights> weights() const;
  [[nodiscard]] DecimateBounds bounds() const;

 private:
  friend void add_simplify_criteria(CLI::App&, const std::shared_ptr<SimplifyCriteria>&);
  std::vector<std::string> weights_;  // NAME=WEIGHT
  DecimateBounds bounds_;             // angles in degrees
  std::optional<double> distance_, relative_distance_, edge_length_;
};

/// The options that fill `given`, which they keep alive.
void add_simplify_criteria(CLI::App& command, const std::shared_ptr<SimplifyCriteria>& given);

}  // namespace vkmesh::cli
