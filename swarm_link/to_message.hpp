// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarm_core/base/ids.hpp"
#include "swarm_core/base/time.hpp"
#include "swarm_core/mission/scene.hpp"
#include "swarm_core/plan/flow_plan.hpp"
#include "swarm_link/messages.hpp"

/// Domain objects as the messages that publish them. The way back is the Gate's.
namespace swarm::link {

/// `t0` is when the plan is published. Entries, scene version and excess are left at their
/// defaults.
PlanMessage to_message(const FlowPlan& plan, PlannerEpoch epoch, PlanVersion version, UtcTime t0);

SceneMessage to_message(const Scene& scene);

}  // namespace swarm::link
