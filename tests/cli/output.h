// Reads what the program wrote.
#pragma once

#include <string>
#include <vector>

#include <vkmesh/mesh/indexed_face_set.h>

namespace vkmesh::test {

/// The mesh in a file; fails the test when it cannot be read.
IndexedFaceSet mesh_in(const std::string& path);
/// The floats of a point channel; fails the test when there is no such channel.
std::vector<float> floats_of(const IndexedFaceSet& mesh, const std::string& channel);
/// The same for corners.
std::vector<float> corner_floats_of(const IndexedFaceSet& mesh, const std::string& channel);

}  // namespace vkmesh::test
