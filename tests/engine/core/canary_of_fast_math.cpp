// The check of a device's arithmetic as it is in a library compiled with -ffast-math (tests/CMakeLists.txt).
#define check_exactness check_exactness_with_fast_math
#include "../../../engine/src/core/canary.cpp"
