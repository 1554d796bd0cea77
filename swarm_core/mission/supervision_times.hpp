// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "swarmflow/core/time.hpp"

/// Times that launcher and robots must agree on.
namespace swarm {

/// Without a status for this long, the launcher reports a process of robots as silent.
inline constexpr Duration kStatusSilence = std::chrono::seconds(3);

/// Rate of the launcher's beats.
inline constexpr double kBeatHz = 2.0;

}  // namespace swarm
