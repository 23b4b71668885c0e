// Opens Vulkan devices in processes of their own first, so that a driver that crashes takes nothing down.
#pragma once

#include <string>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/context.h>

namespace vkmesh::cli {

/// list_devices(), where `usable` tells that the device was opened as `options` say (their device is not
/// looked at), and computes what the host computes. `rejected` names the signal of a driver that crashed.
/// Errors: kNoDevice, also where a driver crashes while the devices are listed, which the loader does for all
/// drivers together.
[[nodiscard]] Result<std::vector<DeviceInfo>> probe_devices(const ContextOptions& options);

/// The index of the device that "auto" means: of the usable devices of probe_devices() the first of discrete,
/// integrated and virtual GPUs; then, where `software` is set, of the others. No device after it is opened.
/// Errors: kNoDevice, with each of these and why it cannot serve; the message is empty where there is none.
[[nodiscard]] Result<std::string> probe_for_auto(const ContextOptions& options, bool software);

}  // namespace vkmesh::cli
