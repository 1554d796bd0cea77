// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "swarm_link/port.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::drivers {

/// The participant of this process in the ROS domain of its environment, shared by its drivers: one
/// of each robot would cost the square of their number in discovery. Joined by the first driver,
/// left with the last. Use it from one thread.
Result<std::shared_ptr<link::Participant>> ros_session();

}  // namespace swarm::drivers
