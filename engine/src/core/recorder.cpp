#include <algorithm>
#include <cmath>
#include <cstring>
#include <thread>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/core/recorder.h>

#include "core/device.h"
#include "core/hazards.h"

namespace vkmesh {
namespace {

constexpr std::uint32_t kMaxSections = 64;

constexpr VkPipelineStageFlags kStages =
    VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
constexpr VkAccessFlags kWrites = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
constexpr VkAccessFlags kReads = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT;
// Where drawing reads buffers.
constexpr VkPipelineStageFlags kDrawStages = VK_PIPELINE_STAGE_VERTEX_INPUT_BIT |
                                             VK_PIPELINE_STAGE_VERTEX_SHADER_BIT |
                                             VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT;
constexpr VkAccessFlags kDrawReads =
    VK_ACCESS_INDEX_READ_BIT | VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_UNIFORM_READ_BIT;

}  // namespace

struct VKMESH_LOCAL Recorder::State {
  enum class Phase { kRecording, kRunning, kDone, kFailed };

  Context context;  // On the same device as the caller's, which may go.
  VkCommandBuffer commands = VK_NULL_HANDLE;
  bool borrowed = false;
  bool drew = false;  // Only then may barriers name the stages of drawing, which not every queue has.
  Phase phase = Phase::kRecording;

  VkCommandPool pool = VK_NULL_HANDLE;
  VkFence fence = VK_NULL_HANDLE;
  VkQueryPool queries = VK_NULL_HANDLE;
  std::chrono::nanoseconds timeout{0};

  std::vector<std::string> sections;
  std::vector<SectionTime> times;
  RecorderCounts counts;
  detail::Hazards<VkBuffer> hazards;

  explicit State(const Context& c) : context(c.shared_device()) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();

  [[nodiscard]] detail::Device& device() const { return context.device(); }
  [[nodiscard]] Result<void> require_recording() const;
  [[nodiscard]] Result<void> require_own(const char* what, const std::string& name,
                                         std::span<const Buffer* const> buffers) const;
  VkResult wait_for_fence() noexcept;
  [[nodiscard]] Result<void> read_times();
  void memory_barrier(VkPipelineStageFlags stages, VkAccessFlags access);
  void order(std::span<const Buffer* const> reads, std::span<const Buffer* const> writes);
};

Recorder::State::~State() {
  if (borrowed) return;
  detail::Device& d = device();
  if (phase == Phase::kRunning) wait_for_fence();
  if (phase == Phase::kRunning) {
    d.abandoned.store(true);
    return;
  }
  const auto& vk = d.functions;
  vk.vkDestroyQueryPool(d.handle, queries, nullptr);
  vk.vkDestroyFence(d.handle, fence, nullptr);
  vk.vkDestroyCommandPool(d.handle, pool, nullptr);
}

Result<void> Recorder::State::require_recording() const {
  if (phase == Phase::kRecording) return {};
  return fail(ErrorCode::kUsage, "the recorder's work was submitted: nothing can be added to it");
}

/// `what` was given the buffers, and has this name if any.
Result<void> Recorder::State::require_own(const char* what, const std::string& name,
                                          std::span<const Buffer* const> buffers) const {
  for (const Buffer* buffer : buffers) {
    if (buffer->exists_in(context)) continue;
    const bool made = buffer->vk_buffer() != VK_NULL_HANDLE;
    return fail(ErrorCode::kUsage,
                what + (name.empty() ? name : " '" + name + "'") + " was given memory that " +
                    (made ? "another context made: a recorder takes what its own context made"
                          : "nothing was written to"));
  }
  return {};
}

void Recorder::State::memory_barrier(VkPipelineStageFlags stages, VkAccessFlags access) {
  const VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr, kWrites, access};
  device().functions.vkCmdPipelineBarrier(commands, drew ? kStages | kDrawStages : kStages, stages, 0, 1,
                                          &barrier, 0, nullptr, 0, nullptr);
  hazards.pass_barrier();
}

void Recorder::State::order(std::span<const Buffer* const> reads, std::span<const Buffer* const> writes) {
  const bool hindered = std::any_of(reads.begin(), reads.end(),
                                    [&](const Buffer* b) { return hazards.hinder_read(b->vk_buffer()); }) ||
                        std::any_of(writes.begin(), writes.end(),
                                    [&](const Buffer* b) { return hazards.hinder_write(b->vk_buffer()); });
  if (hindered) {
    memory_barrier(drew ? kStages | kDrawStages : kStages, kReads | kWrites | (drew ? kDrawReads : 0u));
    ++counts.barriers;
  }
  for (const Buffer* b : reads) hazards.note_read(b->vk_buffer());
  for (const Buffer* b : writes) hazards.note_write(b->vk_buffer());
}

/// Returns VK_SUCCESS, VK_ERROR_DEVICE_LOST, or what kept the wait from seeing the end of work that still
/// runs.
VkResult Recorder::State::wait_for_fence() noexcept {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::nanoseconds kPause = std::chrono::milliseconds(1);
  const detail::Device& d = device();
  const auto begun = Clock::now();
  std::chrono::nanoseconds left = std::max(timeout, std::chrono::nanoseconds(0));
  for (;;) {
    const VkResult result =
        d.functions.vkWaitForFences(d.handle, 1, &fence, VK_TRUE, static_cast<std::uint64_t>(left.count()));
    if (result == VK_SUCCESS) phase = Phase::kDone;
    // A lost device runs nothing any more, so its objects can be destroyed.
    if (result == VK_ERROR_DEVICE_LOST) phase = Phase::kFailed;
    if (phase != Phase::kRunning || result == VK_TIMEOUT) return result;
    // The wait itself failed, for want of memory say, and tells nothing about the work: it is tried again.
    left = timeout - (Clock::now() - begun);
    if (left <= kPause) return result;
    std::this_thread::sleep_for(kPause);
  }
}

Result<void> Recorder::State::read_times() {
  if (queries == VK_NULL_HANDLE || sections.empty()) return {};
  const detail::Device& d = device();
  std::vector<std::uint64_t> ticks(sections.size() + 1);
  VKMESH_VK(d.functions.vkGetQueryPoolResults(d.handle, queries, 0, static_cast<std::uint32_t>(ticks.size()),
                                              ticks.size() * sizeof(std::uint64_t), ticks.data(),
                                              sizeof(std::uint64_t), VK_QUERY_RESULT_64_BIT),
            "reading time-stamps");
  const std::uint64_t mask =
      d.timestamp_bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << d.timestamp_bits) - 1;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const double elapsed = static_cast<double>((ticks[i + 1] - ticks[i]) & mask) * d.timestamp_nanoseconds;
    times.push_back({sections[i], elapsed * 1e-6});
  }
  return {};
}

Recorder::Recorder(std::unique_ptr<State> state) : state_(std::move(state)) {}
Recorder::~Recorder() = default;
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder& Recorder::operator=(Recorder&&) noexcept = default;

Result<Recorder> Recorder::create(Context& context) {
  return detail::catching([&]() -> Result<Recorder> {
    auto state = std::make_unique<State>(context);
    const detail::Device& d = context.device();
    const auto& vk = d.functions;
    const std::string what = "making a command buffer";

    const VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr,
                                       VK_COMMAND_POOL_CREATE_TRANSIENT_BIT, d.queue_family};
    VKMESH_VK(vk.vkCreateCommandPool(d.handle, &pool, nullptr, &state->pool), what);
    const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
    VKMESH_VK(vk.vkCreateFence(d.handle, &fence, nullptr, &state->fence), what);
    const VkCommandBufferAllocateInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr,
                                               state->pool, VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    VKMESH_VK(vk.vkAllocateCommandBuffers(d.handle, &commands, &state->commands), what);
    const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr,
                                         VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT, nullptr};
    VKMESH_VK(vk.vkBeginCommandBuffer(state->commands, &begin), what);
    return Recorder(std::move(state));
  });
}

Result<Recorder> Recorder::into(Context& context, VkCommandBuffer command_buffer) {
  return detail::catching([&]() -> Result<Recorder> {
    if (command_buffer == VK_NULL_HANDLE)
      return fail(ErrorCode::kUsage, "there is no command buffer to record into");
    auto state = std::make_unique<State>(context);
    state->commands = command_buffer;
    state->borrowed = true;
    return Recorder(std::move(state));
  });
}

Context& Recorder::context() const {
  return state_->context;
}

RecorderCounts Recorder::counts() const {
  return state_->counts;
}

std::vector<SectionTime> Recorder::section_times() const {
  return state_->times;
}

Result<void> Recorder::dispatch(const KernelSource& source, std::span<const std::byte> push_constants,
                                std::uint64_t threads, std::span<const Buffer* const> reads,
                                std::span<const Buffer* const> writes) {
  return detail::catching([&]() -> Result<void> {
    VKMESH_CHECK(state_->require_recording());
    VKMESH_TRY(const Kernel* made, state_->device().kernel(source));
    const Kernel& kernel = *made;
    if ((push_constants.size() + 7) / 8 * 8 != kernel.push_constant_bytes())
      return fail(ErrorCode::kUsage,
                  "kernel '" + kernel.name() + "' takes " + std::to_string(kernel.push_constant_bytes()) +
                      " bytes of push constants, not " + std::to_string(push_constants.size()));
    if (threads > 0xffffffffu)
      return fail(ErrorCode::kUsage,
                  "a kernel's elements are counted in 32 bits: " + std::to_string(threads) +
                      " are too many for '" + kernel.name() + "'");
    if (threads == 0) return {};
    for (const auto& buffers : {reads, writes})
      VKMESH_CHECK(state_->require_own("kernel", kernel.name(), buffers));
    const detail::Device& d = state_->device();
    const auto& vk = d.functions;
    const std::uint64_t group = kernel.workgroup_size();
    const std::uint64_t groups_at_once =
        std::clamp<std::uint64_t>(d.options.max_threads_per_dispatch / group, 1, d.max_groups);

    state_->order(reads, writes);
    vk.vkCmdBindPipeline(state_->commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline());
    vk.vkCmdPushConstants(state_->commands, kernel.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                          static_cast<std::uint32_t>(push_constants.size()), push_constants.data());
    // The parts write different elements of the same buffers, so that no barrier goes between them.
    for (std::uint64_t first = 0; first < threads; first += groups_at_once * group) {
      const std::uint32_t range[2] = {
          static_cast<std::uint32_t>(first),
          static_cast<std::uint32_t>(std::min<std::uint64_t>(threads - first, groups_at_once * group))};
      vk.vkCmdPushConstants(state_->commands, kernel.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof range,
                            range);
      vk.vkCmdDispatch(state_->commands, static_cast<std::uint32_t>((range[1] + group - 1) / group), 1, 1);
      ++state_->counts.dispatches;
    }
    return {};
  });
}

Result<void> Recorder::copy(const Buffer& from, const Buffer& to, std::uint64_t bytes,
                            std::uint64_t from_offset, std::uint64_t to_offset) {
  return detail::catching([&]() -> Result<void> {
    VKMESH_CHECK(state_->require_recording());
    if (from_offset > from.size() || bytes > from.size() - from_offset || to_offset > to.size() ||
        bytes > to.size() - to_offset)
      return fail(ErrorCode::kUsage, "a copy reaches past the end of a buffer");
    if (from.vk_buffer() == to.vk_buffer() && from_offset < to_offset + bytes &&
        to_offset < from_offset + bytes)
      return fail(ErrorCode::kUsage, "a copy within a buffer must not overlap itself");
    if (bytes == 0) return {};
    const Buffer* const buffers[] = {&from, &to};
    VKMESH_CHECK(state_->require_own("a copy", "", buffers));
    state_->order({&buffers[0], 1}, {&buffers[1], 1});
    const VkBufferCopy region{from_offset, to_offset, bytes};
    state_->device().functions.vkCmdCopyBuffer(state_->commands, from.vk_buffer(), to.vk_buffer(), 1,
                                               &region);
    ++state_->counts.copies;
    return {};
  });
}

Result<void> Recorder::update(const Buffer& to, std::span<const std::byte> data) {
  return detail::catching([&]() -> Result<void> {
    VKMESH_CHECK(state_->require_recording());
    if (data.size() % 4 != 0 || data.size() > 65536 || data.size() > to.size())
      return fail(ErrorCode::kUsage, "an update of " + std::to_string(data.size()) + " bytes");
    if (data.empty()) return {};
    const Buffer* writes[] = {&to};
    VKMESH_CHECK(state_->require_own("an update", "", writes));
    state_->order({}, writes);
    state_->device().functions.vkCmdUpdateBuffer(state_->commands, to.vk_buffer(), 0, data.size(),
                                                 data.data());
    ++state_->counts.copies;
    return {};
  });
}

Result<void> Recorder::graphics(const std::function<void(VkCommandBuffer)>& commands,
                                std::span<const Buffer* const> reads, std::span<const Buffer* const> writes) {
  return detail::catching([&]() -> Result<void> {
    VKMESH_CHECK(state_->require_recording());
    if (!state_->device().draws)
      return fail(ErrorCode::kNoDevice, "the queue of " + state_->device().info.name + " does not draw");
    for (const auto& buffers : {reads, writes}) VKMESH_CHECK(state_->require_own("drawing", "", buffers));
    state_->drew = true;
    state_->order(reads, writes);
    commands(state_->commands);
    return {};
  });
}

void Recorder::begin_section(const std::string& name) {
  State& s = *state_;
  const detail::Device& d = s.device();
  if (s.borrowed || s.phase != State::Phase::kRecording || d.timestamp_bits == 0 ||
      s.sections.size() >= kMaxSections)
    return;
  const auto& vk = d.functions;
  // A section that cannot be timed is work like any other.
  if (s.queries == VK_NULL_HANDLE) {
    VkQueryPoolCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = kMaxSections + 1;
    if (vk.vkCreateQueryPool(d.handle, &info, nullptr, &s.queries) != VK_SUCCESS) {
      s.queries = VK_NULL_HANDLE;
      return;
    }
    vk.vkCmdResetQueryPool(s.commands, s.queries, 0, kMaxSections + 1);
  }
  try {
    s.sections.push_back(name);
  } catch (const std::bad_alloc&) {
    return;
  }
  vk.vkCmdWriteTimestamp(s.commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, s.queries,
                         static_cast<std::uint32_t>(s.sections.size() - 1));
}

Result<void> Recorder::submit_and_wait(std::chrono::nanoseconds timeout) {
  return detail::catching([&]() -> Result<void> {
    State& s = *state_;
    if (s.borrowed) return fail(ErrorCode::kUsage, "the command buffer is the caller's to submit");
    VKMESH_CHECK(s.require_recording());
    detail::Device& d = s.device();
    if (!s.sections.empty())
      d.functions.vkCmdWriteTimestamp(s.commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, s.queries,
                                      static_cast<std::uint32_t>(s.sections.size()));
    // What was written is for the host, and for whatever the queue runs next.
    s.memory_barrier(kStages | VK_PIPELINE_STAGE_HOST_BIT, kReads | kWrites | VK_ACCESS_HOST_READ_BIT);
    s.phase = State::Phase::kFailed;
    VKMESH_VK(d.functions.vkEndCommandBuffer(s.commands), "recording work for " + d.info.name);

    VkSubmitInfo submit{};
    submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &s.commands;
    VKMESH_CHECK(d.submit(submit, s.fence));
    s.phase = State::Phase::kRunning;
    return wait(timeout);
  });
}

Result<void> Recorder::wait(std::chrono::nanoseconds timeout) {
  return detail::catching([&]() -> Result<void> {
    if (state_->phase == State::Phase::kDone) return {};
    if (state_->phase != State::Phase::kRunning)
      return fail(ErrorCode::kUsage, "no work was submitted to wait for");
    state_->timeout = timeout;
    const std::string& name = state_->device().info.name;
    const VkResult result = state_->wait_for_fence();
    if (result == VK_TIMEOUT)
      return fail(ErrorCode::kNoDevice,
                  name + " did not finish its work within " +
                      std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(timeout).count()) +
                      " ms");
    VKMESH_VK(result, "waiting for " + name);
    return state_->read_times();
  });
}

}  // namespace vkmesh
