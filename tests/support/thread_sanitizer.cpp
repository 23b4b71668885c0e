// What the thread sanitizer does not tell of test programs: atomic members of TBB's tasks lie where ordinary
// ones lay before, or come to lie, on a stack or in TBB's own pools.
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
  return "race_top:bits/atomic_base.h\nrace_top:std::atomic<tbb::";
}
