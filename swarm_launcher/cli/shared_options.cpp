// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/cli/shared_options.hpp"

#include <algorithm>
#include <cstddef>
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

// A request is a short line: a longer token would make the launcher drop the connection.
void add_join_token(CLI::App& command, std::string& token) {
  constexpr std::size_t kMost = 256;
  command
      .add_option("--join-token", token,
                  "Secret that launcher and joining hosts share (default: none is asked for)")
      ->envname("SWARMFLOW_JOIN_TOKEN")
      ->check([](const std::string& text) {
        const bool printable =
            std::ranges::all_of(text, [](char c) { return c > ' ' && c < '\x7f'; });
        return printable && text.size() <= kMost ? std::string()
                                                 : std::string("up to 256 printable characters");
      });
}

}  // namespace swarm::launcher::cli
