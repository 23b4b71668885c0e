// Recorders of work for a device.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan_core.h>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/engine/core/buffer.h>
#include <vkmesh/engine/core/context.h>
#include <vkmesh/engine/core/kernel.h>

namespace vkmesh {

/// Device time of a section of the work.
struct SectionTime {
  std::string name;
  double milliseconds = 0.0;
};

/// Counts of what a recorder has recorded so far.
struct RecorderCounts {
  std::uint32_t dispatches = 0;  ///< vkCmdDispatch calls: split work counts each part.
  std::uint32_t copies = 0;
  std::uint32_t barriers = 0;  ///< Between pieces of work; the one that closes a submission is not counted.
};

/// Records kernels (see dispatch.h) and copies in the order of the calls. Each says which buffers it reads
/// and writes; where one touches what an earlier one wrote, or writes what an earlier one read, a memory
/// barrier goes between them, and nowhere else. Buffers must live until the work has run, and be of the
/// recorder's context: else the error is kUsage. One thread at a time.
class VKMESH_API Recorder {
 public:
  /// Records into a command buffer of its own, to be run by submit_and_wait(). Errors: kOutOfMemory,
  /// kNoDevice.
  [[nodiscard]] static Result<Recorder> create(Context& context);

  /// Records into the caller's command buffer, which must be recording, outside a render pass, for the
  /// context's queue family. The caller submits it, and places the barriers against its own work before and
  /// after: the recorder's work runs in the stages COMPUTE_SHADER and TRANSFER, and drawing in those of a
  /// graphics pipeline. Sections are not timed. Errors: kUsage for a null handle.
  [[nodiscard]] static Result<Recorder> into(Context& context, VkCommandBuffer command_buffer);

  /// Waits (at most as long as the last wait) for work that still runs. What work that did not end may use is
  /// never destroyed: this recorder's own objects, and from then on all of the context's.
  ~Recorder();
  Recorder(Recorder&&) noexcept;
  Recorder& operator=(Recorder&&) noexcept;

  [[nodiscard]] Context& context() const;

  /// Copies `bytes` bytes. Errors: kUsage for ranges outside the buffers, or after submit_and_wait().
  [[nodiscard]] Result<void> copy(const Buffer& from, const Buffer& to, std::uint64_t bytes,
                                  std::uint64_t from_offset = 0, std::uint64_t to_offset = 0);

  /// Writes `data` to the start of a buffer; the bytes travel in the command buffer. Errors: kUsage for a
  /// size that is no multiple of four, above 65536 or above the buffer's, or after submit_and_wait().
  [[nodiscard]] Result<void> update(const Buffer& to, std::span<const std::byte> data);

  /// Calls `commands` with the command buffer, to record drawing that reads and writes these buffers: as
  /// vertices, indices and in shaders, or by transfers. A render pass must begin and end inside. Errors:
  /// kNoDevice where the queue does not draw; kUsage after submit_and_wait().
  [[nodiscard]] Result<void> graphics(const std::function<void(VkCommandBuffer)>& commands,
                                      std::span<const Buffer* const> reads,
                                      std::span<const Buffer* const> writes);

  /// Starts a section, whose time section_times() tells; it ends where the next one starts, or with the work.
  /// At most 64 sections; further ones, and all of them on a device without time-stamps, are not timed.
  void begin_section(const std::string& name);

  /// Runs what was recorded, and waits until it is done or the time is up. To be called once.
  /// Errors: kNoDevice for a device that was lost or did not finish in time; kOutOfMemory, where waiting
  /// still lacked memory when the time was up; kUsage for a second call, or on the caller's command buffer.
  /// Unless the device was lost the work then still runs, and wait() goes on waiting.
  [[nodiscard]] Result<void> submit_and_wait(std::chrono::nanoseconds timeout = std::chrono::seconds(60));
  [[nodiscard]] Result<void> wait(std::chrono::nanoseconds timeout);

  /// Times of the sections, in order of recording; empty before the work is done, or where the device has no
  /// time-stamps.
  [[nodiscard]] std::vector<SectionTime> section_times() const;
  [[nodiscard]] RecorderCounts counts() const;

 private:
  struct State;
  explicit Recorder(std::unique_ptr<State> state);
  template <class Params>
  friend class Dispatch;
  [[nodiscard]] Result<void> dispatch(const KernelSource& source, std::span<const std::byte> push_constants,
                                      std::uint64_t threads, std::span<const Buffer* const> reads,
                                      std::span<const Buffer* const> writes);

  std::unique_ptr<State> state_;
};

}  // namespace vkmesh
