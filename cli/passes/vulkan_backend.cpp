#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "passes/backend.h"
#include "passes/device_probe.h"

namespace vkmesh::cli {

Result<void> Backend::run_steps(
    std::uint32_t steps, const std::function<Result<void>(Recorder&, std::uint32_t, std::uint32_t)>& record) {
  const Progress progress = job_.progress("smoothing");
  for (std::uint32_t done = 0, portion = 1; done < steps;) {
    if (steps > 1 && !progress(static_cast<double>(done) / steps))
      return fail(ErrorCode::kInterrupted, "interrupted");
    const std::uint32_t end = done + std::min(portion, steps - done);
    VKMESH_TRY(const double milliseconds, run_recorded(*context_, [&](Recorder& recorder) {
                 // Adjacency is uploaded here, when the first portion asks for it.
                 return job_.timed("upload", [&] { return record(recorder, done, end); });
               }));
    job_.book("device", milliseconds);
    done = end;
    if (milliseconds < 100) portion *= 2;
  }
  return {};
}

Result<double> run_recorded(Context& context, const std::function<Result<void>(Recorder&)>& record) {
  VKMESH_TRY(Recorder recorder, Recorder::create(context));
  recorder.begin_section("pass");
  VKMESH_CHECK(record(recorder));
  const auto start = std::chrono::steady_clock::now();
  VKMESH_CHECK(recorder.submit_and_wait(std::chrono::minutes(10)));
  const double wall =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  // The device's own clock leaves the host's share out.
  const auto sections = recorder.section_times();
  return sections.empty() ? wall : sections[0].milliseconds;
}

ContextOptions context_options(const std::string& device) {
  ContextOptions options;
  options.device = device;
#ifndef NDEBUG
  options.validation = true;
  options.on_validation_message = [](const std::string& message) {
    std::fprintf(stderr, "validation: %s\n", message.c_str());
  };
#endif
  return options;
}

void report_device(Job& job, const DeviceInfo& info) {
  job.json()["device"] = {{"name", info.name},
                          {"driver", info.driver},
                          {"type", name_of(info.type)},
                          {"api_version", info.api_version}};
  job.row("device",
          info.name + "; " + info.driver + "; " + name_of(info.type) + "; Vulkan " + info.api_version);
}

Result<std::unique_ptr<Context>> open_context(Job& job, const std::string& device) {
  VKMESH_TRY(std::unique_ptr<Context> context, job.timed("open", [&]() -> Result<std::unique_ptr<Context>> {
    ContextOptions options = context_options(device);
    if (device == "auto") {
      VKMESH_TRY(options.device, probe_for_auto(options, false));
    }
    return Context::create(options);
  }));
  report_device(job, context->info());
  return context;
}

}  // namespace vkmesh::cli
