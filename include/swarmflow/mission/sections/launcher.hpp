// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "swarmflow/mission/launcher_loss.hpp"
#include "swarmflow/mission/options.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {

/// Key `launcher`: start and end of a run's processes.
struct LauncherSpec {
  double starts_per_s = 60.0;      ///< rate of process starts
  std::uint32_t starting_max = 8;  ///< most processes started but not received yet
  double quorum_share = 1.0;       ///< share of robots that is enough after the timeout
  double quorum_timeout_s = 30.0;  ///< until then all are waited for; missing ones are reported
  double time_limit_s = 600.0;     ///< longest mission time
  std::uint32_t respawn_planner_max = 3;                  ///< restarts in a row, see below
  std::uint32_t respawn_agent_max = 0;                    ///< the same, of each agent process
  LauncherLoss on_launcher_loss = LauncherLoss::kFinish;  ///< when its beats stop
};

/// Keys of the section.
inline constexpr auto kLauncherKeys = std::to_array<SectionKey<LauncherSpec>>({
    {"starts_per_s", &LauncherSpec::starts_per_s, positive(10'000),
     "largest number of processes started per second"},
    {"starting_max", &LauncherSpec::starting_max, between(1, 10'000),
     "largest number of started processes from which nothing was received yet"},
    {"quorum_share", &LauncherSpec::quorum_share, positive(1),
     "after quorum_timeout_s the mission starts with at least this share of the robots"},
    {"quorum_timeout_s", &LauncherSpec::quorum_timeout_s, positive(3600),
     "time to wait for all robots; then the missing ones are reported"},
    {"time_limit_s", &LauncherSpec::time_limit_s, positive(1e6),
     "longest mission time; then the run fails"},
    {"respawn_planner_max", &LauncherSpec::respawn_planner_max, between(0, 1000),
     "restarts in a row of a planner before the mission starts; one more death ends the run. In "
     "flight the planner is always restarted"},
    {"respawn_agent_max", &LauncherSpec::respawn_agent_max, between(0, 1000),
     "restarts in a row of a robot's process, each after less than 20 s of life; after one more "
     "death it is not restarted. 0: never restarted"},
    {"on_launcher_loss", &LauncherSpec::on_launcher_loss, between(0, 1),
     "what robots do when the launcher's beats stop for timing.launcher_silence_s"},
});

}  // namespace swarm
