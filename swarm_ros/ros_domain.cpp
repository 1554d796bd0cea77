// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_ros/ros_domain.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>

#include "swarm_core/base/foreign_settings.hpp"
#include "swarm_link/adapters/cyclone/cyclone_participant.hpp"
#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"

namespace swarm::ros {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
constexpr std::uint32_t kMaxDomain = 232;  // ports beyond it do not exist
constexpr std::uint16_t kServerPort = 11811;
/// By it the command-line tools of ROS 2 recognise a node's participant.
constexpr const char* kUserData = "enclave=/;";

template <class Number>
std::optional<Number> number(std::string_view text, Number most) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value > most) return {};
  return value;
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    if (end > 0) parts.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

tl::unexpected<Error> wrong(const char* variable, const std::string& value, const char* remedy) {
  return fail(ErrorCode::kBadInput, fmt::format("{} is '{}'; {}", variable, value, remedy));
}

/// The IPv4 address of a host: the DDS libraries take no names.
std::optional<std::string> resolved(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  addrinfo* found = nullptr;
  if (host.empty() || ::getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0) return {};
  char text[INET_ADDRSTRLEN] = {};
  sockaddr_in at{};
  std::memcpy(&at, found->ai_addr, sizeof at);
  ::freeaddrinfo(found);
  return ::inet_ntop(AF_INET, &at.sin_addr, text, sizeof text);
}

Result<link::DiscoveryAddress> server_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  link::DiscoveryAddress address{.host = text.substr(0, colon), .port = kServerPort};
  if (colon != std::string::npos) {
    const auto port = number<std::uint16_t>(std::string_view(text).substr(colon + 1), 65535);
    if (!port)
      return wrong("ROS_DISCOVERY_SERVER", text, "must be one address, as 127.0.0.1:11811");
    address.port = *port;
  }
  const auto host = resolved(address.host);
  if (!host || text.find(';') != std::string::npos) {
    return wrong("ROS_DISCOVERY_SERVER", text, "must be one address, as 127.0.0.1:11811");
  }
  address.host = *host;
  return address;
}

}  // namespace

Result<RosDomain> ros_domain(const std::function<std::string(const char*)>& variable) {
  RosDomain domain;
  if (const auto id = variable("ROS_DOMAIN_ID"); !id.empty()) {
    const auto value = number<std::uint32_t>(id, kMaxDomain);
    if (!value) return wrong("ROS_DOMAIN_ID", id, "must be a number from 0 to 232");
    domain.domain = *value;
  }
  const auto middleware = variable("RMW_IMPLEMENTATION");
  if (middleware == "rmw_cyclonedds_cpp") {
    domain.vendor = link::Vendor::kCycloneDds;
  } else if (!middleware.empty() && !middleware.starts_with("rmw_fastrtps")) {
    return wrong("RMW_IMPLEMENTATION", middleware,
                 "robots are reached by rmw_fastrtps_cpp and rmw_cyclonedds_cpp");
  }
  const auto range = variable("ROS_AUTOMATIC_DISCOVERY_RANGE");
  if (range == "OFF") return wrong("ROS_AUTOMATIC_DISCOVERY_RANGE", range, "no robot can be found");
  if (!range.empty() && range != "SUBNET" && range != "LOCALHOST" && range != "SYSTEM_DEFAULT") {
    return wrong("ROS_AUTOMATIC_DISCOVERY_RANGE", range, "must be SUBNET or LOCALHOST");
  }
  const auto only = variable("ROS_LOCALHOST_ONLY");
  if (!only.empty() && only != "0" && only != "1") {
    return wrong("ROS_LOCALHOST_ONLY", only, "must be 0 or 1");
  }
  for (const std::string& peer : split(variable("ROS_STATIC_PEERS"), ';')) {
    const auto address = resolved(peer);
    if (!address) return wrong("ROS_STATIC_PEERS", peer, "is no host that is known here");
    domain.peers.push_back(*address);
  }
  // A participant of loopback alone would not reach peers.
  domain.localhost_only =
      domain.peers.empty() && (range == "LOCALHOST" || (range.empty() && only == "1"));
  if (const auto server = variable("ROS_DISCOVERY_SERVER"); !server.empty()) {
    if (domain.vendor != link::Vendor::kFastDds) {
      return wrong("ROS_DISCOVERY_SERVER", server,
                   "it is one of Fast DDS, and not for Cyclone DDS");
    }
    if (const auto address = server_address(server); !address)
      return tl::unexpected(address.error());
    domain.server = server;
  }
  return domain;
}

Result<RosDomain> ros_domain_of_environment() {
  return ros_domain([](const char* name) { return foreign_setting(name); });
}

Result<std::unique_ptr<link::Participant>> join(const RosDomain& domain, const std::string& name) {
  const std::string interface = domain.localhost_only ? kLoopback : "";
  if (domain.vendor == link::Vendor::kCycloneDds) {
    return link::make_cyclone_participant({.name = name,
                                           .domain = domain.domain,
                                           .interface = interface,
                                           .open_peers = domain.peers,
                                           .user_data = kUserData});
  }
  link::OpenDomain open{.peers = domain.peers, .user_data = kUserData};
  if (domain.server) {
    const auto address = server_address(*domain.server);
    if (!address) return tl::unexpected(address.error());
    open.server = *address;
  }
  return link::make_fastdds_participant({.name = name,
                                         .domain = domain.domain,
                                         .open = std::move(open),
                                         .interface = interface,
                                         .receive_at_tick = false});
}

}  // namespace swarm::ros
