#include "job/channels.h"

#include <algorithm>
#include <span>
#include <string>
#include <variant>

#include "job/common.h"

namespace vkmesh::cli {
namespace {

std::vector<std::uint32_t> not_zero(const Channel& channel) {
  std::vector<std::uint32_t> found;
  std::visit(
      [&](const auto& values) {
        for (std::size_t i = 0; i < values.size(); ++i)
          if (values[i] != 0 && (found.empty() || found.back() != i / channel.components))
            found.push_back(static_cast<std::uint32_t>(i / channel.components));
      },
      channel.values);
  return found;
}

}  // namespace

bool can_be_mixed(const Channel& channel) {
  return channel.labels.empty() && !std::holds_alternative<std::vector<std::int32_t>>(channel.values) &&
         !std::holds_alternative<std::vector<std::uint32_t>>(channel.values);
}

BorderCount count_borders(const HalfEdgeMesh& mesh, const Channel& channel) {
  const std::size_t n = channel.components;
  BorderCount count;
  std::visit(
      [&](const auto& values) {
        const std::span all(values);
        for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
          const std::uint32_t twin = mesh.twin(HalfEdgeId(h)).index;
          if (twin == kInvalid || twin < h) continue;
          ++count.edges;
          count.borders +=
              std::ranges::equal(all.subspan(h / 3 * n, n), all.subspan(twin / 3 * n, n)) ? 0 : 1;
        }
      },
      channel.values);
  return count;
}

bool has_regions(const BorderCount& count, const Channel& channel) {
  return count.borders > 0 && !(can_be_mixed(channel) && 2 * count.borders >= count.edges);
}

Result<Marked> find_marked(const IndexedFaceSet& mesh, const std::string& name) {
  const Channel *of_points = find_channel(mesh.point_channels, name),
                *of_faces = find_channel(mesh.face_channels, name);
  if (of_points == nullptr && of_faces == nullptr)
    return fail(ErrorCode::kUsage,
                "--lock " + name + ": neither points nor faces have an attribute of this name");
  Marked marked;
  if (of_points != nullptr) marked.vertices = not_zero(*of_points);
  if (of_faces != nullptr) marked.faces = not_zero(*of_faces);
  return marked;
}

Result<void> drop_normals(Job& job, std::initializer_list<std::vector<Channel>*> lists) {
  std::size_t dropped = 0;
  for (auto* channels : lists)
    dropped += std::erase_if(*channels, [](const Channel& c) { return c.name == "normal"; });
  if (dropped == 0) return {};
  return job.note_dropped(
      "normal", "normals do not fit the new surface and were left out; vkmesh normals makes new ones");
}

}  // namespace vkmesh::cli
