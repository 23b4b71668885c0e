// The one place that compiles tinygltf, a library of one header.
#include <fstream>  // Named by the header even where it is told to leave files alone.

#define TINYGLTF_IMPLEMENTATION
#include "io/gltf/tinygltf.h"
