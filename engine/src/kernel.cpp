#include <vkmesh/engine/kernel.h>

#include "catching.h"
#include "device.h"

namespace vkmesh {

Result<const Kernel*> Kernel::get(Context& context, const KernelSource& source) {
  return detail::catching([&] { return context.device().kernel(source); });
}

}  // namespace vkmesh
