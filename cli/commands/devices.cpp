// vkmesh devices: the Vulkan devices of this machine.
#include "commands.h"

#ifdef VKMESH_HAS_VULKAN
#include "passes/backend.h"
#include "passes/device_probe.h"
#endif

namespace vkmesh::cli {
namespace {

#ifdef VKMESH_HAS_VULKAN

Result<void> print_devices(Job& job) {
  Json& listed = job.json()["result"]["devices"];
  listed = Json::array();
  const auto devices = probe_devices(context_options("auto"));
  if (!devices && devices.error().code != ErrorCode::kNoDevice) return tl::unexpected<Error>(devices.error());
  if (!devices) job.note("no Vulkan device: " + devices.error().message);
  if (devices && devices->empty()) job.note("no Vulkan device: the loader finds none");
  for (const DeviceInfo& info : devices.value_or(std::vector<DeviceInfo>{})) {
    listed.push_back({{"index", info.index},
                      {"name", info.name},
                      {"driver", info.driver},
                      {"type", name_of(info.type)},
                      {"api_version", info.api_version},
                      {"memory", info.memory},
                      {"usable", info.usable},
                      {"rejected", info.usable ? Json(nullptr) : Json(info.rejected)}});
    job.row(std::to_string(info.index), info.name + "; " + info.driver + "; " + name_of(info.type) +
                                            "; Vulkan " + info.api_version + "; " +
                                            grouped(info.memory >> 20) + " MiB" +
                                            (info.usable ? "" : "; rejected: " + info.rejected));
  }
  job.row("cpu", "the host itself; always there");
  return {};
}

#else

Result<void> print_devices(Job& job) {
  job.json()["result"]["devices"] = Json::array();
  job.note("this program was built without Vulkan: it knows no device but cpu");
  job.row("cpu", "the host itself; always there");
  return {};
}

#endif

}  // namespace

void add_devices(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("devices", "Lists the Vulkan devices, and why one cannot serve");
  command->footer(
      "The index, or a part of the name in any case, is what --device takes. auto takes the first usable "
      "discrete,\n"
      "integrated or virtual GPU; software devices serve when they are named. Each device is opened in a "
      "process of its "
      "own,\nso that a driver that crashes is only named, and its arithmetic is compared with the host's.\n\n"
      "Example:\n  vkmesh devices");
  add_common_options(*command, program.options, false, false);
  command->callback([&program] {
    program.command = "devices";
    program.action = print_devices;
  });
}

}  // namespace vkmesh::cli
