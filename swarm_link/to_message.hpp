// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarm_link/messages.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/scene.hpp"

/// Converts domain objects to the messages that publish them. The Gate does the opposite.
namespace swarm::link {

/// `t0` is when the plan is published. Entries, scene version and excess are left at their
/// defaults.
PlanMessage to_message(const FlowPlan& plan, PlannerEpoch epoch, PlanVersion version, UtcTime t0);

SceneMessage to_message(const Scene& scene);

}  // namespace swarm::link
