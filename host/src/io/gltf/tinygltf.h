// tinygltf, as this library uses it: structure only. Images and files are none of its business.
#pragma once

// Programs that embed vkmesh may bring a tinygltf of their own.
#define tinygltf vkmesh_tinygltf
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>
