#include "commands/simplify/simplify_attributes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <type_traits>
#include <variant>

namespace vkmesh::cli {
namespace {

/// Whether values between two of the channel's mean something: not so where they number things.
bool can_be_mixed(const Channel& channel) {
  return channel.labels.empty() && !std::holds_alternative<std::vector<std::int32_t>>(channel.values) &&
         !std::holds_alternative<std::vector<std::uint32_t>>(channel.values);
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

}  // namespace

Result<SimplifyAttributes> SimplifyAttributes::of(Job& job, IndexedFaceSet& mesh,
                                                  const std::vector<std::string>& given, bool vertices_stay) {
  VKMESH_TRY(Weights weights, weights_by_name(given));
  std::optional<double> all;
  if (const auto it = weights.find("all"); it != weights.end()) {
    all = it->second;
    weights.erase(it);
  }
  const auto weight_of = [&](const Channel& channel) -> std::optional<double> {
    if (const auto it = weights.find(channel.name); it != weights.end()) return it->second;
    return can_be_mixed(channel) ? all : std::nullopt;
  };
  for (const auto& [name, weight] : weights) {
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

  SimplifyAttributes result;
  result.vertices_stay_ = vertices_stay;
  for (Channel& channel : mesh.point_channels) {
    if (const auto weight = weight_of(channel))
      result.parts_.push_back({result.point_channels_.size(), false, *weight, floats_of(channel)});
    result.point_channels_.push_back(std::move(channel));
  }
  for (Channel& channel : mesh.corner_channels) {
    std::optional<double> weight = weight_of(channel);
    if (weight == 0.0) {
      job.note("the attribute " + channel.name +
               " of corners was left out, and its seams with it: its weight is 0");
      continue;
    }
    if (!weight && can_be_mixed(channel) && channel.name != "normal") weight = kDefaultWeight;
    if (!weight) {
      job.note("the attribute " + channel.name + " of corners was left out" +
               (can_be_mixed(channel) ? ": --attribute " + channel.name + " keeps it, and its seams"
                                      : ": its values can not be mixed"));
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
  for (const Part& part : result.parts_) result.names_.push_back(result.channel_of(part).name);
  return result;
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
  output.point_channels = point_channels_;
  give_faces(decimated, output);
}

}  // namespace vkmesh::cli
