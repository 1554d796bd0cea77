// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "swarmflow/mission/options.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {

/// Key `timing`: timeouts between processes.
struct TimingSpec {
  double heartbeat_hz = 5.0;          ///< rate of the planner's heartbeats
  double planner_silence_s = 2.0;     ///< robots hold after this time without a heartbeat
  double launcher_silence_s = 3.0;    ///< the launcher is lost after this time without a beat
  double neighbour_forget_s = 2.0;    ///< a silent neighbour is extrapolated for this long
  double clock_skew_warn_s = 0.25;    ///< stamps off by more are reported
  double clock_skew_refuse_s = 10.0;  ///< messages from further in the future are refused
};

/// Keys of the section.
inline constexpr auto kTimingKeys = std::to_array<SectionKey<TimingSpec>>({
    {"heartbeat_hz", &TimingSpec::heartbeat_hz, between(2, 1000),
     "the planner's heartbeats per second"},
    {"planner_silence_s", &TimingSpec::planner_silence_s, positive(3600),
     "without a heartbeat for this long robots hold; avoidance stays active"},
    {"launcher_silence_s", &TimingSpec::launcher_silence_s, between(1, 3600),
     "without a beat for this long the launcher is lost; see launcher.on_launcher_loss"},
    {"neighbour_forget_s", &TimingSpec::neighbour_forget_s, positive(60),
     "in simulations a silent neighbour is extrapolated until then; in flight it keeps its place"},
    {"clock_skew_warn_s", &TimingSpec::clock_skew_warn_s, positive(3600),
     "a larger difference of clocks is reported"},
    {"clock_skew_refuse_s", &TimingSpec::clock_skew_refuse_s, positive(3600),
     "messages with a larger difference of clocks are refused"},
});

}  // namespace swarm
