// A clock for tests of what is asked and when, whatever the machine.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>

#include <catch2/catch.hpp>

#include "base/stop.h"

namespace vkmesh::test {

inline std::atomic<int> g_questions = 0;

/// The time that goes on by a second each time that it is asked for: what lasts n seconds ends at the n-th
/// question, and the caller is called at each that his thread asks.
inline detail::Stop::Clock::time_point asking_clock() {
  return detail::Stop::Clock::time_point(std::chrono::seconds(++g_questions));
}

/// How many questions `step` asks the stop that it is given.
inline int questions_of(const std::function<void(detail::Stop&)>& step) {
  const Progress silent;
  g_questions = 0;
  detail::Stop never(silent, {}, std::numeric_limits<double>::infinity(), asking_clock);
  step(never);
  return g_questions;
}

/// Checks that `step` asks at least so often, spread over all of it, and ends where it is told to.
inline void check_asks(int at_least, const std::function<void(detail::Stop&)>& step) {
  const int questions = questions_of(step);
  CAPTURE(questions);
  CHECK(questions >= at_least);
  const Progress silent;
  for (int n = 1; n <= questions; n += 1 + n / 8) {
    CAPTURE(n);
    g_questions = 0;
    detail::Stop late(silent, {}, n, asking_clock);
    step(late);
    CHECK(late.is_time_over());
    // Each part of a loop that threads have shared out asks once more.
    CHECK(g_questions <= n + questions / 4 + 24);
  }
}

}  // namespace vkmesh::test
