#include "passes/device_probe.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <functional>
#include <memory>

#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "job/common.h"

namespace vkmesh::cli {
namespace {

constexpr std::chrono::seconds kPatience{60};

/// What came of work in a process of its own: what it returned, or how the process ended instead.
struct Outcome {
  std::string returned;
  std::string ended;  ///< "crashes (Illegal instruction)"; empty where the work returned.
};

/// Reads until the other end is closed. False where nothing came for too long, or the program is interrupted.
bool read_all(int from, std::string& text) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  std::array<char, 4096> bytes{};
  while (!interrupted()) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    pollfd waiting{from, POLLIN, 0};
    if (poll(&waiting, 1, static_cast<int>(left.count())) <= 0) continue;
    const ssize_t size = read(from, bytes.data(), bytes.size());
    if (size == 0) return true;
    if (size > 0) text.append(bytes.data(), static_cast<std::size_t>(size));
  }
  return false;
}

/// Runs `work` in a child of this process. It finds no threads of the parent's there.
Outcome in_child_process(const std::function<std::string()>& work) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return {{}, std::string("cannot be tried: ") + std::strerror(errno)};
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    return {{}, std::string("cannot be tried: ") + std::strerror(errno)};
  }
  if (child == 0) {
    close(ends[0]);
    // A sanitizer's handlers, and the program's own, would not let it die of the signal.
    for (const int number : {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGINT, SIGSEGV, SIGTERM})
      (void)std::signal(number, SIG_DFL);
    const rlimit no_core{0, 0};
    (void)setrlimit(RLIMIT_CORE, &no_core);
    const std::string result = work();
    for (std::size_t at = 0; at < result.size();) {
      const ssize_t size = write(ends[1], result.data() + at, result.size() - at);
      if (size <= 0) _exit(1);
      at += static_cast<std::size_t>(size);
    }
    _exit(0);  // Without the parent's exit handlers, and without what its streams hold.
  }
  close(ends[1]);
  Outcome outcome;
  const bool in_time = read_all(ends[0], outcome.returned);
  close(ends[0]);
  if (!in_time) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!in_time)
    outcome.ended = "does not answer within " + std::to_string(kPatience.count()) + " s";
  else if (WIFSIGNALED(status))
    outcome.ended = std::string("crashes (") + strsignal(WTERMSIG(status)) + ")";
  else if (WEXITSTATUS(status) != 0)
    outcome.ended = "ends the program (exit code " + std::to_string(WEXITSTATUS(status)) + ")";
  return outcome;
}

Json to_json(const DeviceInfo& info) {
  return {{"index", info.index},        {"name", info.name},       {"driver", info.driver},
          {"type", info.type},          {"api", info.api_version}, {"memory", info.memory},
          {"rounds", info.loop_rounds}, {"usable", info.usable},   {"rejected", info.rejected}};
}

DeviceInfo from_json(const Json& json) {
  return {json.at("index"),  json.at("name"),   json.at("driver"), json.at("type"),    json.at("api"),
          json.at("memory"), json.at("rounds"), json.at("usable"), json.at("rejected")};
}

struct Listing {
  Result<std::vector<DeviceInfo>> devices;
  bool crashed = false;  ///< Which is then the error.
};

Listing list_in_child() {
  const Outcome outcome = in_child_process([] {
    const auto devices = list_devices();
    Json listed = {{"devices", Json::array()}};
    if (!devices)
      listed["error"] = {{"code", devices.error().code}, {"message", devices.error().message}};
    else
      for (const DeviceInfo& info : *devices) listed["devices"].push_back(to_json(info));
    // Names are a driver's, and need not be UTF-8.
    return listed.dump(-1, ' ', false, Json::error_handler_t::replace);
  });
  if (interrupted()) return {fail(ErrorCode::kInterrupted, "interrupted")};
  if (!outcome.ended.empty())
    return {fail(ErrorCode::kNoDevice,
                 "a Vulkan driver " + outcome.ended +
                     " while devices are listed; VK_LOADER_DEBUG=driver shows which drivers there are, and "
                     "VK_DRIVER_FILES=MANIFEST.json makes the loader take one of them alone"),
            true};
  const Json listed = Json::parse(outcome.returned);
  if (listed.contains("error"))
    return {fail(listed["error"].at("code").get<ErrorCode>(), listed["error"].at("message"))};
  std::vector<DeviceInfo> devices;
  for (const Json& device : listed["devices"]) devices.push_back(from_json(device));
  return {std::move(devices)};
}

/// Opens the device in a child process, and makes it unusable where that fails.
void try_opening(DeviceInfo& device, ContextOptions options) {
  if (!device.usable) return;
  options.device = std::to_string(device.index);
  const Outcome outcome = in_child_process([&options] {
    const auto context = Context::create(options);
    return context ? std::string() : context.error().message;
  });
  device.rejected = outcome.ended.empty() ? outcome.returned : outcome.ended + " while it is opened";
  device.usable = device.rejected.empty();
}

}  // namespace

Result<std::vector<DeviceInfo>> probe_devices(const ContextOptions& options) {
  VKMESH_TRY(std::vector<DeviceInfo> devices, list_in_child().devices);
  for (DeviceInfo& device : devices) {
    if (interrupted()) return fail(ErrorCode::kInterrupted, "interrupted");
    try_opening(device, options);
  }
  return devices;
}

Result<std::string> probe_for_auto(const ContextOptions& options, bool software) {
  Listing listing = list_in_child();
  if (!listing.devices && listing.devices.error().code == ErrorCode::kNoDevice && !listing.crashed)
    return fail(ErrorCode::kNoDevice, "");
  VKMESH_TRY(std::vector<DeviceInfo> devices, std::move(listing.devices));
  // The enumerators stand in the order of preference.
  std::stable_sort(devices.begin(), devices.end(),
                   [](const DeviceInfo& a, const DeviceInfo& b) { return a.type < b.type; });
  std::string reasons;
  for (DeviceInfo& device : devices) {
    if (device.type >= DeviceType::kSoftware && !software) continue;
    try_opening(device, options);
    if (interrupted()) return fail(ErrorCode::kInterrupted, "interrupted");
    if (device.usable) return std::to_string(device.index);
    reasons += (reasons.empty() ? "" : "; ") + device.name + ": " + device.rejected;
  }
  return fail(ErrorCode::kNoDevice, reasons);
}

}  // namespace vkmesh::cli
