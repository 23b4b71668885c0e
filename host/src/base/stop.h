// How long work is stopped, told of, and done step by step.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <thread>

#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>

namespace vkmesh::detail {

/// Whether to stop before the end, because the time is over or the caller wants it. Long steps ask() again
/// and again, on any thread; what they have done by then is whole.
class Stop {
 public:
  using Clock = std::chrono::steady_clock;
  /// What tells the time, on any thread.
  using Now = Clock::time_point (*)();

  /// From `begun` on, for so many seconds. `progress` is called on this thread alone, and must outlive this.
  Stop(const Progress& progress, Clock::time_point begun, double seconds, Now now = &Clock::now)
      : progress_(progress), begun_(begun), seconds_(seconds), now_(now), heard_(begun) {}

  [[nodiscard]] bool is_set() const { return is_cancelled() || is_time_over(); }
  [[nodiscard]] bool is_cancelled() const { return cancelled_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool is_time_over() const { return time_over_.load(std::memory_order_relaxed); }

  /// Looks at the clock, and calls the caller if that was long ago.
  void ask() {
    const Clock::time_point now = now_();
    if (std::chrono::duration<double>(now - begun_).count() >= seconds_)
      time_over_.store(true, std::memory_order_relaxed);
    if (std::this_thread::get_id() == thread_ && now - heard_ >= kLong) tell(fraction_, now);
  }
  /// Tells the caller how much is done; on the thread of the caller.
  void report(double fraction) { tell(fraction, now_()); }
  /// Errors: kInterrupted where the caller wants it.
  [[nodiscard]] Result<void> check() {
    ask();
    if (is_cancelled()) return fail(ErrorCode::kInterrupted, "cancelled");
    return {};
  }
  /// For steps that give nothing unless they come to their end. Errors: kInterrupted where the caller wants
  /// it or the time is over.
  [[nodiscard]] Result<void> go_on() {
    VKMESH_CHECK(check());
    if (is_time_over()) return fail(ErrorCode::kInterrupted, "the time is over");
    return {};
  }

 private:
  void tell(double fraction, Clock::time_point now) {
    fraction_ = fraction;
    heard_ = now;
    if (progress_ && !progress_(fraction)) cancelled_.store(true, std::memory_order_relaxed);
  }

  static constexpr std::chrono::milliseconds kLong{250};

  const Progress& progress_;
  Clock::time_point begun_;
  double seconds_;
  Now now_;
  Clock::time_point heard_;  // of the caller
  double fraction_ = 0;
  std::thread::id thread_ = std::this_thread::get_id();
  std::atomic<bool> cancelled_ = false, time_over_ = false;
};

/// For the parts of a long step: asks, and tells whether to go on; always where there is nobody to ask.
[[nodiscard]] inline bool goes_on(Stop* stop) {
  if (stop == nullptr) return true;
  stop->ask();
  return !stop->is_set();
}

/// Calls step() until done(), or until it returns false: there is nothing left to do. Returns whether that
/// was so. Every `between_reports` steps the caller is told of fraction(), what of the work is done. done()
/// must heed the stop.
template <class Done, class Step, class Fraction>
[[nodiscard]] bool run_steps(Stop& stop, std::size_t between_reports, Done&& done, Step&& step,
                             Fraction&& fraction) {
  for (std::size_t steps = 0; !done(); ++steps) {
    if (steps % between_reports == 0) stop.report(fraction());
    stop.ask();
    if (!done() && !step() && !done()) return true;
  }
  return false;
}

}  // namespace vkmesh::detail
