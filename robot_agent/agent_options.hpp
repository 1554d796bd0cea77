// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "robot_agent/loop/pose_check.hpp"
#include "robot_agent/neighbours/neighbour_table.hpp"
#include "robot_agent/safety/safety_filter.hpp"
#include "robot_agent/send_policy.hpp"
#include "swarm_core/base/shared.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/body_limits.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/robot/control_registry.hpp"
#include "swarmflow/robot/route.hpp"

namespace swarm::agent {

/// What robots with the same body have in common.
struct AgentOptions {
  PreparedControl control;
  RouteOptions route;
  SafetyOptions safety;
  NeighbourOptions neighbours;
  SendOptions send;
  PoseLimits pose;
  double scale = 1.0;  ///< of the constants of the agent (body_scale.hpp)
};

/// The options of a robot of a mission, and of any other with its body.
/// Fails with kBadInput if the registry lacks the control method, and with the method's error if
/// that refuses the mission.
Result<Shared<AgentOptions>> agent_options(const Mission& mission, RobotId robot,
                                           const ControlRegistry& registry);
/// The same with a built-in method. \pre mission.control.method is one
Shared<AgentOptions> agent_options(const Mission& mission, RobotId robot);

/// The options of all robots of a mission, made once for each body. The mission outlives it.
class AgentOptionsOf {
 public:
  /// Fails as agent_options() does, for the first body that it fails for.
  static Result<AgentOptionsOf> make(const Mission& mission, const ControlRegistry& registry);
  /// With a built-in method.
  explicit AgentOptionsOf(const Mission& mission);

  /// The options of one robot. O(log bodies).
  const Shared<AgentOptions>& operator()(RobotId robot) const;
  /// Whether the control method reads the planned density.
  bool reads_density() const;

 private:
  AgentOptionsOf(const Mission& mission, std::map<const BodySpec*, Shared<AgentOptions>> by_body);

  const Mission* mission_;
  std::map<const BodySpec*, Shared<AgentOptions>> by_body_;
};

}  // namespace swarm::agent
