#include "output.h"

#include <catch2/catch.hpp>

#include <vkmesh/io/mesh_io.h>

namespace vkmesh::test {

IndexedFaceSet mesh_in(const std::string& path) {
  auto file = read_mesh(path);
  if (!file) FAIL(file.error().describe());
  auto mesh = to_indexed_face_set(std::move(*file));
  if (!mesh) FAIL(mesh.error().describe());
  return std::move(*mesh);
}

namespace {

std::vector<float> floats_in(const std::vector<Channel>& channels, const std::string& channel) {
  const Channel* found = find_channel(channels, channel);
  if (found == nullptr) FAIL("there is no channel " << channel);
  const auto* values = std::get_if<std::vector<float>>(&found->values);
  if (values == nullptr) FAIL("the channel " << channel << " holds no floats");
  return *values;
}

}  // namespace

std::vector<float> floats_of(const IndexedFaceSet& mesh, const std::string& channel) {
  return floats_in(mesh.point_channels, channel);
}

std::vector<float> corner_floats_of(const IndexedFaceSet& mesh, const std::string& channel) {
  return floats_in(mesh.corner_channels, channel);
}

}  // namespace vkmesh::test
