// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/cli/shared_options.hpp"

#include <map>
#include <string>

namespace swarm::launcher::cli {

// "auto" leaves the choice empty: choose_channel() then decides by the number of processes.
void add_channel(CLI::App& command, std::optional<Channel>& channel) {
  static const std::map<std::string, std::optional<Channel>> kChannels = {
      {"auto", std::nullopt}, {"topics", Channel::kTopics}, {"groups", Channel::kGroups}};
  command
      .add_option_function<std::string>(
          "--channel", [&channel](const std::string& name) { channel = kChannels.at(name); },
          "What carries robot states: DDS topics, multicast groups, or auto")
      ->check(CLI::IsMember(kChannels));
}

// The highest domains have no room for the ports of many participants: see DomainLock.
void add_domain(CLI::App& command, int& domain) {
  command.add_option("--domain", domain, "DDS domain (default: a free one)")
      ->check(CLI::Range(0, 229));
}

}  // namespace swarm::launcher::cli
