// The criteria of a decimation beside its quadric error.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <vkmesh/decimation/decimate.h>

#include "job/common.h"

namespace vkmesh::cli {

/// What was given on the command line.
struct SimplifyCriteria {
  std::vector<std::string> weights;  // NAME=WEIGHT
  DecimateCriteria bounds;           // angles in degrees

  /// Errors: kUsage, for a name or a weight that is none.
  [[nodiscard]] Result<DecimateCriteria> criteria() const;
};

/// The options that fill `given`, which they keep alive.
void add_simplify_criteria(CLI::App& command, const std::shared_ptr<SimplifyCriteria>& given);

}  // namespace vkmesh::cli
