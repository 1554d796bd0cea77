// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "experiments/soak/soak_measurements.hpp"
#include "experiments/soak/soak_paths.hpp"
#include "swarm_launcher/flight/flight_loop.hpp"
#include "swarm_link/channels/groups/group_tap.hpp"

namespace swarm::launcher {

/// Samples the processes of a flight once a second and receives all its states in a thread of its
/// own.
class SoakWatch final : public FlightObserver {
 public:
  explicit SoakWatch(std::uint32_t robots);
  ~SoakWatch() override;
  SoakWatch(const SoakWatch&) = delete;
  SoakWatch& operator=(const SoakWatch&) = delete;

  /// Starts the listener's thread. Without it the latency from written to received is not measured.
  void listen(std::unique_ptr<link::GroupTap> tap);

  void on_status(const link::StatusMessage& status) override;
  void on_heartbeat(SteadyTime now) override;
  void on_step(const FlightLoop& flight, SteadyTime now) override;
  std::string describe() override;

  /// The measurements so far.
  SoakMeasurements measurements() const;

 private:
  /// The loop of the listener's thread.
  void receive_all();
  /// Takes one sample of all processes.
  void sample(const FlightLoop& flight, SteadyTime now);

  /// Counters of a robot when the mission began and now.
  struct Robot {
    std::uint32_t process_id = 0;
    link::RobotStatusMessage first{}, last{};
  };
  std::vector<Robot> robots_;
  std::map<std::uint32_t, std::vector<link::HistogramBinMessage>> ages_;  // by process
  PathMeter paths_;
  std::vector<SoakSample> samples_;
  SteadyTime sampled_at_;
  double cpu_s_ = 0.0;
  std::uint64_t switches_ = 0, received_ = 0;
  std::uint64_t drops_before_ = 0, drops_ = 0;

  std::unique_ptr<link::GroupTap> tap_;
  mutable std::mutex mutex_;
  link::StreamMeter meter_;  // of the listener
  std::atomic<bool> running_ = false;
  std::atomic<bool> ended_ = false;
  std::thread listener_;
};

}  // namespace swarm::launcher
