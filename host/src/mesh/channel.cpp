#include <algorithm>
#include <utility>

#include <vkmesh/mesh/channel.h>

namespace vkmesh {

const Channel* find_channel(const std::vector<Channel>& channels, const std::string& name) {
  const auto it =
      std::find_if(channels.begin(), channels.end(), [&](const Channel& c) { return c.name == name; });
  return it == channels.end() ? nullptr : &*it;
}

void set_channel(std::vector<Channel>& channels, Channel channel) {
  const auto it = std::find_if(channels.begin(), channels.end(),
                               [&](const Channel& c) { return c.name == channel.name; });
  if (it == channels.end())
    channels.push_back(std::move(channel));
  else
    *it = std::move(channel);
}

Channel gather(const Channel& channel, std::span<const std::uint32_t> from) {
  ChannelValues values = std::visit(
      [&](const auto& given) -> ChannelValues {
        std::remove_cvref_t<decltype(given)> kept;
        kept.reserve(from.size() * channel.components);
        for (const std::size_t element : from)
          for (unsigned k = 0; k < channel.components; ++k)
            kept.push_back(given[element * channel.components + k]);
        return kept;
      },
      channel.values);
  return {channel.name, channel.components, std::move(values), channel.labels};
}

std::vector<Channel> gather(const std::vector<Channel>& channels, std::span<const std::uint32_t> from) {
  std::vector<Channel> kept;
  kept.reserve(channels.size());
  for (const Channel& channel : channels) kept.push_back(gather(channel, from));
  return kept;
}

}  // namespace vkmesh
