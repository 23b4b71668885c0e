#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/core/kernel.h>

#include "core/device.h"

namespace vkmesh {

Result<const Kernel*> Kernel::get(Context& context, const KernelSource& source) {
  return detail::catching([&] { return context.device().kernel(source); });
}

}  // namespace vkmesh
