// Progress of long work, and the way to cancel it.
#pragma once

#include <functional>

namespace vkmesh {

/// Called now and then on the calling thread with the fraction done, in [0, 1]. Returning false cancels: the
/// function then returns ErrorCode::kInterrupted and leaves the caller's data as it was. May be empty.
using Progress = std::function<bool(double fraction)>;

}  // namespace vkmesh
