// What Catch2 has to be compiled once: its own main, for every test program.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>

#if defined(VKMESH_THREAD_SANITIZER)
/// What the thread sanitizer does not tell: atomic members of TBB's tasks lie where ordinary ones lay before,
/// or come to lie, on a stack or in TBB's own pools.
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
  return "race_top:bits/atomic_base.h\nrace_top:std::atomic<tbb::";
}
#endif
