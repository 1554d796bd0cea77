// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/chaos/chaos_means.hpp"
#include "experiments/chaos/fault_schedule.hpp"
#include "experiments/chaos/flight_processes.hpp"
#include "experiments/chaos/small_disk.hpp"
#include "swarmflow/core/box.hpp"
#include "swarmflow/core/linalg.hpp"

namespace swarm::launcher {

/// What faults hit.
struct FaultTargets {
  std::filesystem::path run_dir;
  FlightParents parents;
  Box bounds_m;         ///< of the map, for obstacles
  SteppedClock* clock;  ///< the three that are empty are not hit
  HostPair* hosts;
  SmallDisk* disk;
};

/// Whether no robot of a run is within a distance of a point, by the ends of the robot logs.
bool is_clear_of_robots(const std::filesystem::path& run_dir, const Vec2& at_m, double distance_m);

/// Injects the faults of one flight as their times come, and undoes them.
class FaultInjector {
 public:
  FaultInjector(std::vector<Fault> schedule, FaultTargets targets);

  /// Injects and undoes what is due at this time of the mission.
  void play(Duration mission_time);
  /// Undoes all that has not been undone.
  void undo_all(Duration mission_time);

  /// Those that were injected: one whose process had ended by then is left out.
  const std::vector<Fault>& injected() const { return injected_; }

 private:
  struct Open {
    Fault fault;
    pid_t frozen;
    Duration until;
  };

  bool inject(const Fault& fault);
  void undo(const Open& open);
  bool signal(std::optional<pid_t> pid, int number);
  bool command(std::vector<std::string> arguments);
  bool add_obstacle(const Fault& fault);
  bool is_command_delayed(Duration mission_time) const;
  void log(Duration mission_time, const Fault& fault, const char* edge) const;

  std::vector<Fault> schedule_;
  FaultTargets targets_;
  std::size_t next_ = 0;
  pid_t signalled_ = 0;  ///< process of the last signal
  std::vector<Open> open_;
  std::vector<Fault> injected_;
};

}  // namespace swarm::launcher
