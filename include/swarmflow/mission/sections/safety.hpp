// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "swarmflow/mission/options.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {

/// Key `safety`: the safety filter between every control method and the driver.
struct SafetySpec {
  double gap_share = 0.5;            ///< γ: share of the gap a robot may close by one command
  double stale_gain = 1.0;           ///< a: extra closing time per information age
  double neighbour_margin_m = 0.25;  ///< m: gap kept to other robots [m]
  double obstacle_margin_m = 0.05;   ///< m_o: gap kept to obstacles and bounds [m]
  double follow_share = 0.8;         ///< β: usable share of a neighbour's retreating speed
};

/// Keys of the section.
inline constexpr auto kSafetyKeys = std::to_array<SectionKey<SafetySpec>>({
    {"gap_share", &SafetySpec::gap_share, positive(1),
     "share of the gap that a robot may close by one command"},
    {"stale_gain", &SafetySpec::stale_gain, between(0, 100),
     "how much slower a gap may close the older the neighbour's state is"},
    {"neighbour_margin_m", &SafetySpec::neighbour_margin_m, between(0, 100),
     "surface gap that robots keep to each other"},
    {"obstacle_margin_m", &SafetySpec::obstacle_margin_m, between(0, 100),
     "surface gap that robots keep to obstacles"},
    {"follow_share", &SafetySpec::follow_share, between(0, 1),
     "share of a neighbour's retreating speed by which a robot may follow"},
});

}  // namespace swarm
