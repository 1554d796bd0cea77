// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "swarm_core/mission/vendor.hpp"
#include "swarm_link/port.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::ros {

/// A domain of ROS 2 and how its nodes discover each other.
struct RosDomain {
  link::Vendor vendor = link::Vendor::kFastDds;
  std::uint32_t domain = 0;
  bool localhost_only = false;
  std::vector<std::string> peers{};  ///< IPv4 addresses to announce ourselves to beside multicast
  std::optional<std::string> server{};  ///< `host:port` of a discovery server of Fast DDS
};

/// As the environment of a ROS user sets it: ROS_DOMAIN_ID, RMW_IMPLEMENTATION,
/// ROS_AUTOMATIC_DISCOVERY_RANGE (or ROS_LOCALHOST_ONLY), ROS_STATIC_PEERS, ROS_DISCOVERY_SERVER.
/// Names of hosts are resolved. kBadInput, with the variable's name, for a value that has no
/// meaning or is not supported (range OFF; a middleware other than the two DDS vendors). \param
/// variable value of an environment variable; empty if it is not set
Result<RosDomain> ros_domain(const std::function<std::string(const char*)>& variable);
/// Of this process.
Result<RosDomain> ros_domain_of_environment();

/// Joins it, as a node without services; over UDP alone.
Result<std::unique_ptr<link::Participant>> join(const RosDomain& domain, const std::string& name);

}  // namespace swarm::ros
