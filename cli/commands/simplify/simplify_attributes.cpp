#include "commands/simplify/simplify_attributes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <type_traits>
#include <variant>

#include "job/channel_numbers.h"
#include "job/channels.h"

namespace vkmesh::cli {
namespace {

/// Whether what points have takes part unless something else was said. Other small integers may number
/// things.
bool takes_part(const Channel& channel) {
  const auto is = [&](const char* name) { return channel.name == name; };
  const bool is_real = std::holds_alternative<std::vector<float>>(channel.values) ||
                       std::holds_alternative<std::vector<double>>(channel.values);
  return can_be_mixed(channel) && (is_real || is("normal") || is("uv") || is("color") || is("quality"));
}

std::vector<float> floats_of(const Channel& channel) {
  return std::visit([](const auto& v) { return std::vector<float>(v.begin(), v.end()); }, channel.values);
}

/// A channel like another, of the values at these elements.
Channel channel_like(const Channel& like, std::span<const float> values,
                     std::span<const std::uint32_t> elements) {
  const unsigned n = like.components;
  ChannelValues made = std::visit(
      [&](const auto& given) -> ChannelValues {
        std::remove_cvref_t<decltype(given)> v;
        v.reserve(elements.size() * n);
        using Scalar = typename std::remove_cvref_t<decltype(given)>::value_type;
        for (const std::size_t e : elements)
          for (unsigned k = 0; k < n; ++k) {
            const float x = values[e * n + k];
            if constexpr (std::is_floating_point_v<Scalar>)
              v.push_back(static_cast<Scalar>(x));
            else
              v.push_back(static_cast<Scalar>(std::floor(static_cast<double>(x) + 0.5)));
          }
        return v;
      },
      like.values);
  return {like.name, n, std::move(made), like.labels};
}

constexpr double kDefaultWeight = DecimateAttribute{}.weight;

using Weights = std::map<std::string, double>;

Result<Weights> weights_by_name(const std::vector<std::string>& given) {
  Weights weights;
  for (const std::string& text : given) {
    VKMESH_TRY(const auto named, named_weight("--attribute", text, kDefaultWeight));
    weights[named.first] = named.second;
  }
  return weights;
}

/// The first of the names that no channel of the mesh has.
std::optional<std::string> unknown_name(const IndexedFaceSet& mesh, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (find_channel(mesh.point_channels, name) == nullptr &&
        find_channel(mesh.corner_channels, name) == nullptr &&
        find_channel(mesh.face_channels, name) == nullptr)
      return name;
  return std::nullopt;
}

/// Weights by name, and that of all others, if there is one.
struct NamedWeights {
  Weights by_name;
  std::optional<double> all;

  [[nodiscard]] std::optional<double> of(const Channel& channel) const {
    if (const auto it = by_name.find(channel.name); it != by_name.end()) return it->second;
    return can_be_mixed(channel) ? all : std::nullopt;
  }
};

Result<NamedWeights> named_weights(const IndexedFaceSet& mesh, const std::vector<std::string>& given) {
  NamedWeights result;
  VKMESH_TRY(result.by_name, weights_by_name(given));
  if (const auto it = result.by_name.find("all"); it != result.by_name.end()) {
    result.all = it->second;
    result.by_name.erase(it);
  }
  for (const auto& [name, weight] : result.by_name) {
    const Channel* channel = find_channel(mesh.point_channels, name);
    if (channel == nullptr) channel = find_channel(mesh.corner_channels, name);
    if (channel == nullptr)
      return fail(ErrorCode::kUsage,
                  "--attribute " + name +
                      ": neither points nor corners have an attribute of this name (vkmesh "
                      "info lists those there are)");
    if (!can_be_mixed(*channel))
      return fail(ErrorCode::kUsage,
                  "--attribute " + name + ": its values number things, and none lies between two");
  }
  return result;
}

}  // namespace

Result<SimplifyAttributes> SimplifyAttributes::of(Job& job, IndexedFaceSet& mesh,
                                                  const HalfEdgeMesh& half_edges,
                                                  const AttributeChoice& choice, bool vertices_stay) {
  VKMESH_TRY(const NamedWeights weights, named_weights(mesh, choice.weights));
  if (const auto name = unknown_name(mesh, choice.dropped))
    return fail(ErrorCode::kUsage, "--drop-attribute " + *name +
                                       ": the mesh has no attribute of this name (vkmesh info lists those "
                                       "there are)");
  for (auto* channels : {&mesh.point_channels, &mesh.corner_channels, &mesh.face_channels})
    std::erase_if(*channels, [&](const Channel& channel) {
      return std::ranges::find(choice.dropped, channel.name) != choice.dropped.end();
    });

  SimplifyAttributes result;
  result.vertices_stay_ = vertices_stay;
  for (Channel& channel : mesh.point_channels) {
    std::optional<double> weight = weights.of(channel);
    if (!weight && takes_part(channel) && channel.name != choice.lock)
      weight = channel.name == "normal" ? 0.0 : kDefaultWeight;
    // What does not count and can not change is taken along with the points.
    if (weight && (*weight > 0 || !vertices_stay))
      result.parts_.push_back({result.point_channels_.size(), false, *weight, floats_of(channel)});
    result.point_channels_.push_back(std::move(channel));
  }
  for (Channel& channel : mesh.corner_channels) {
    std::optional<double> weight = weights.of(channel);
    if (weight == 0.0) {
      VKMESH_CHECK(job.note_dropped(channel.name,
                                    "the attribute " + channel.name +
                                        " of corners was left out, and its seams with it: its weight is 0"));
      continue;
    }
    if (!weight && can_be_mixed(channel) && channel.name != "normal") weight = kDefaultWeight;
    if (!weight) {
      VKMESH_CHECK(job.note_dropped(
          channel.name,
          "the attribute " + channel.name + " of corners was left out" +
              (can_be_mixed(channel) ? ": --attribute " + channel.name + " keeps it, and its seams"
                                     : ": its values can not be mixed")));
      continue;
    }
    result.parts_.push_back({result.corner_channels_.size(), true, *weight, floats_of(channel)});
    result.corner_channels_.push_back(std::move(channel));
  }
  result.face_channels_ = std::move(mesh.face_channels);
  mesh.point_channels = mesh.corner_channels = mesh.face_channels = {};
  if (!result.corner_channels_.empty()) {
    result.each_corner_.resize(mesh.corners.size());
    std::iota(result.each_corner_.begin(), result.each_corner_.end(), 0u);
  }
  if (choice.material_borders) result.find_borders(job, half_edges);
  for (const Part& part : result.parts_) result.names_.push_back(result.channel_of(part).name);
  return result;
}

void SimplifyAttributes::find_borders(Job& job, const HalfEdgeMesh& half_edges) {
  for (const Channel& channel : face_channels_) {
    if (channel.name == "normal") continue;
    const BorderCount count = count_borders(half_edges, channel);
    if (count.borders == 0) continue;
    if (!has_regions(count, channel)) {
      job.note("the attribute " + channel.name +
               " of faces changes from face to face: its borders are not kept");
      continue;
    }
    borders_.push_back(channel.name);
    const std::vector<std::uint32_t> numbers = numbers_of_values({&channel, 1});
    std::vector<std::uint32_t> number_of_corner(half_edges.half_edge_count());
    for (std::size_t c = 0; c < number_of_corner.size(); ++c) number_of_corner[c] = numbers[c / 3];
    tell_apart(number_of_corner);
  }
}

void SimplifyAttributes::tell_apart(std::span<const std::uint32_t> number_of_corner) {
  if (number_of_corner.empty()) return;
  groups_.resize(number_of_corner.size(), 0);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;
  for (std::size_t c = 0; c < groups_.size(); ++c)
    groups_[c] =
        known.try_emplace({groups_[c], number_of_corner[c]}, static_cast<std::uint32_t>(known.size()))
            .first->second;
}

std::vector<std::string> SimplifyAttributes::unmixed_points() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < point_channels_.size(); ++i)
    if (std::ranges::none_of(parts_, [&](const Part& p) { return !p.of_corners && p.channel == i; }))
      names.push_back(point_channels_[i].name);
  return names;
}

std::vector<std::string> SimplifyAttributes::corner_names() const {
  std::vector<std::string> names;
  for (const Channel& channel : corner_channels_) names.push_back(channel.name);
  return names;
}

void SimplifyAttributes::add_to(DecimateOptions& options) const {
  for (const Part& part : parts_) {
    const Channel& channel = channel_of(part);
    DecimateAttribute attribute;
    attribute.components = channel.components;
    attribute.values = part.values;
    if (part.of_corners) attribute.corners = each_corner_;
    attribute.weight = part.weight;
    if (channel.name == "normal" && channel.components == 3) attribute.kind = AttributeKind::kNormal;
    options.attributes.push_back(attribute);
  }
  options.corner_groups = groups_;
}

void SimplifyAttributes::give_faces(const Decimated& decimated, IndexedFaceSet& output) const {
  output.face_channels = gather(face_channels_, decimated.source_face);
  if (!vertices_stay_ || corner_channels_.empty()) return;
  std::vector<std::uint32_t> corners;
  corners.reserve(decimated.attributes.corners.size());
  for (const std::uint32_t w : decimated.attributes.corners)
    corners.push_back(decimated.attributes.source_corner[w]);
  output.corner_channels = gather(corner_channels_, corners);
}

void SimplifyAttributes::give(const Decimated& decimated, IndexedFaceSet& output) const {
  output.point_channels = gather(point_channels_, decimated.source_vertex);
  give_faces(decimated, output);
  if (vertices_stay_ || parts_.empty()) return;
  std::vector<std::uint32_t> wedge(output.points.size());
  for (std::size_t c = 0; c < output.corners.size(); ++c)
    wedge[output.corners[c]] = decimated.attributes.corners[c];
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    const std::span<const float> values = decimated.attributes.values[i];
    if (part.of_corners)
      output.corner_channels.push_back(channel_like(channel_of(part), values, decimated.attributes.corners));
    else
      output.point_channels[part.channel] = channel_like(channel_of(part), values, wedge);
  }
}

void SimplifyAttributes::append_points(const std::vector<std::uint32_t>& points,
                                       IndexedFaceSet& output) const {
  if (points.empty()) return;
  for (std::size_t i = 0; i < output.point_channels.size(); ++i) {
    const Channel more = gather(point_channels_[i], points);
    std::visit(
        [&](auto& values) {
          const auto& added = std::get<std::remove_cvref_t<decltype(values)>>(more.values);
          values.insert(values.end(), added.begin(), added.end());
        },
        output.point_channels[i].values);
  }
}

void SimplifyAttributes::give_index_only(const Decimated& decimated, IndexedFaceSet& output) const {
  give_faces(decimated, output);
  // What vertices have, corners had only while the surface was connected.
  std::erase_if(output.corner_channels, [&](const Channel& channel) {
    return find_channel(output.point_channels, channel.name) != nullptr;
  });
}

}  // namespace vkmesh::cli
