// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::launcher {

/// A mission that keeps a swarm of any size moving at the same density: all robots cross an open
/// square back and forth until the time is up.
Result<Mission> soak_mission(std::uint32_t robots, double rate_hz, double duration_s);

}  // namespace swarm::launcher
