// What subcommands ask about attributes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/mesh/channel.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/indexed_face_set.h>

namespace vkmesh::cli {

class Job;

/// Whether values between two of the channel's mean something: not so where they number things.
[[nodiscard]] bool can_be_mixed(const Channel& channel);

/// How many of the edges between two faces have different values of a channel of faces on their sides.
struct BorderCount {
  std::size_t borders = 0, edges = 0;
};
[[nodiscard]] BorderCount count_borders(const HalfEdgeMesh& mesh, const Channel& channel);

/// Whether the faces that differ in the channel are those of regions, whose borders are to be kept; not where
/// values change from face to face.
[[nodiscard]] bool has_regions(const BorderCount& count, const Channel& channel);

/// Points and faces whose value in the channel of that name is not 0.
struct Marked {
  std::vector<std::uint32_t> vertices, faces;
};
/// For --lock NAME. Errors: kUsage where neither points nor faces have a channel of this name.
[[nodiscard]] Result<Marked> find_marked(const IndexedFaceSet& mesh, const std::string& name);

/// Takes normals out of lists of channels, where they would not fit the new surface. Errors: those of
/// Job::note_dropped.
[[nodiscard]] Result<void> drop_normals(Job& job, std::initializer_list<std::vector<Channel>*> lists);

}  // namespace vkmesh::cli
