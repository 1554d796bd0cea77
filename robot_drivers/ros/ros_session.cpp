// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_drivers/ros/ros_session.hpp"

#include "swarm_ros/ros_domain.hpp"

namespace swarm::drivers {

Result<std::shared_ptr<link::Participant>> ros_session() {
  static std::weak_ptr<link::Participant> shared;
  if (auto session = shared.lock()) return session;
  const auto domain = ros::ros_domain_of_environment();
  if (!domain) return tl::unexpected(domain.error());
  auto joined = ros::join(*domain, "swarmflow");
  if (!joined) return tl::unexpected(joined.error());
  std::shared_ptr<link::Participant> session = *std::move(joined);
  shared = session;
  return session;
}

}  // namespace swarm::drivers
