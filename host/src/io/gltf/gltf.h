// What reading and writing glTF share.
#pragma once

#include <string>

namespace vkmesh::detail {

/// The name of the channel for an attribute of a file; empty for one that is not read.
[[nodiscard]] std::string gltf_channel_name(const std::string& attribute);

}  // namespace vkmesh::detail
