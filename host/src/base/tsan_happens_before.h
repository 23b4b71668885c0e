// What the thread sanitizer cannot see for itself.
#pragma once

#if defined(VKMESH_THREAD_SANITIZER)
#include <sanitizer/tsan_interface.h>
#endif

namespace vkmesh::detail {

/// What one thread does before give() comes before what another does after take(), where the second waits
/// for the first. TBB sees to that waiting, and is not built with the thread sanitizer: without being told,
/// that takes each loop for a race, or has to be silent about all of them.
class Handover {
 public:
#if defined(VKMESH_THREAD_SANITIZER)
  void give() {
    __tsan_release(this);
  }
  void take() {
    __tsan_acquire(this);
  }
#else
  void give() {}
  void take() {}
#endif

  /// For as long as it lives, a piece of work that comes after one thing and before another.
  class Work {
   public:
    Work(Handover& after, Handover& before) : before_(before) { after.take(); }
    ~Work() { before_.give(); }
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

   private:
    Handover& before_;
  };
};

}  // namespace vkmesh::detail
