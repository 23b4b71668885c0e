// What Catch2 has to be compiled once: its own main, for every test program.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
