#include <algorithm>
#include <utility>

#include <vkmesh/channel.h>

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

}  // namespace vkmesh
