// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/box.hpp"

namespace swarm::launcher {

/// Robots whose processes die at one time of a simulated mission, as by `kill -9`.
struct Kill {
  double at_s = 0.0;              ///< mission time
  std::vector<RobotId> robots{};  ///< these; if empty:
  std::uint32_t count = 0;        ///< so many, drawn by the seed …
  std::optional<Box> in_m{};      ///< … among those whose centre is inside
};

/// Reads `ids:3,7@60`, `10@60` or `10@60,in=90:40:110:60` (x0:y0:x1:y1 in metres). Fails
/// (kBadInput) with what is allowed.
Result<Kill> parse_kill(std::string_view text);

/// A robot that may be chosen.
struct Candidate {
  RobotId robot;
  Vec2 position_m = Vec2::Zero();
};

/// Which of the living robots die, by id. Fewer than asked for if there are not so many.
std::vector<RobotId> choose(const Kill& kill, std::span<const Candidate> living,
                            std::uint64_t seed);

}  // namespace swarm::launcher
