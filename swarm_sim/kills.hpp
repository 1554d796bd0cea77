// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "swarmflow/core/box.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Robots whose processes die at one time of a simulated mission, as by `kill -9`.
struct Kill {
  double at_s = 0.0;              ///< mission time
  std::vector<RobotId> robots{};  ///< the robots that die; empty: `count` robots are drawn
  std::uint32_t count = 0;        ///< number of robots drawn by the seed, without a list
  std::optional<Box> in_m{};      ///< only robots whose centre is inside are drawn; empty: all
};

/// Reads `ids:3,7@60`, `10@60` or `10@60,in=90:40:110:60` (x0:y0:x1:y1 in metres). Fails
/// (kBadInput) with the forms that are allowed.
Result<Kill> parse_kill(std::string_view text);

/// A robot whose process is alive, and may be killed.
struct Candidate {
  RobotId robot;
  Vec2 position_m = Vec2::Zero();
};

/// The robots that die, in the order of their ids; fewer than requested if there are fewer.
std::vector<RobotId> choose(const Kill& kill, std::span<const Candidate> living,
                            std::uint64_t seed);

}  // namespace swarm::launcher
