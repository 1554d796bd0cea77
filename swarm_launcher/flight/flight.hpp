// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "swarm_core/app/file_watch.hpp"
#include "swarm_launcher/flight/flight_loop.hpp"
#include "swarm_launcher/flight/prepared_run.hpp"
#include "swarm_launcher/flight/run_helpers.hpp"
#include "swarm_launcher/processes/child_process.hpp"

namespace swarm::launcher {

/// A flight with real processes, in real time: a PreparedRun, the FlightLoop that flies it, and
/// what connects the two with the operating system. Single thread.
class Flight {
 public:
  /// Prepares the run, see PreparedRun. \pre the observer, if any, outlives the flight
  static Result<std::unique_ptr<Flight>> make(FlightOptions options,
                                              FlightObserver* observer = nullptr);
  Flight(const Flight&) = delete;
  Flight& operator=(const Flight&) = delete;

  /// Flies the whole mission, from the first process to the last. Call it once.
  Result<Measurements> fly();

  const std::filesystem::path& dir() const { return run_->dir(); }
  Channel channel() const { return run_->channel().channel; }
  std::uint32_t domain() const { return run_->info().domain; }
  /// The planner's log, for the user when planning failed.
  std::string planner_complaint() const;

 private:
  Flight(std::unique_ptr<PreparedRun> run, FlightObserver* observer);

  void report_channel();
  /// Prints where other hosts join.
  void report_hosts();
  /// Waits for the robot logs of other hosts, a few minutes at most.
  void collect_robot_logs();
  /// Reports, once a second, whether the files of the run can be written.
  void watch_files(const FlightTime& now);
  /// Writes what waits, and returns what is missing in the files of the run.
  std::vector<std::string> finish_files();

  std::unique_ptr<PreparedRun> run_;
  EventLog events_;
  Progress progress_;
  FlightLog log_;
  std::unique_ptr<ControlRequests> requests_;
  ChildSpawner spawner_;
  RunHelpers helpers_;
  std::optional<StopOrder> stop_;
  std::unique_ptr<link::StopReceiver> stops_;
  std::optional<BeatSender> beats_;
  std::optional<FlightLoop> loop_;
  shell::FileWatch file_watch_;
  SteadyTime next_look_{};
};

}  // namespace swarm::launcher
