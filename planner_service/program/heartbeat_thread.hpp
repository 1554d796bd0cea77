// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "planner_service/program/heartbeat_source.hpp"
#include "swarm_link/port.hpp"

namespace swarm::planner {

/// Publishes heartbeats from a thread of its own, so that a planner which computes a plan for long
/// does not look dead. The functions may be called from any thread; each holds a lock for
/// microseconds. Destruction ends the thread.
class HeartbeatThread {
 public:
  /// A heartbeat every `period` from now on.
  HeartbeatThread(link::WriterPtr<link::HeartbeatMessage> writer, const HeartbeatSource& source,
                  Duration period);
  ~HeartbeatThread();
  HeartbeatThread(const HeartbeatThread&) = delete;
  HeartbeatThread& operator=(const HeartbeatThread&) = delete;

  /// The state after a step of the planner's loop.
  void on_step(const PlannerState& state);
  /// As HeartbeatSource's.
  void pause();
  void begin_epoch(PlannerEpoch epoch);
  /// One more heartbeat at once, which does not change the period.
  void beat();
  /// The clock in the last heartbeat.
  PlanClock published() const;

 private:
  void run();
  void beat_locked();

  link::WriterPtr<link::HeartbeatMessage> writer_;
  HeartbeatSource source_;
  Duration period_;
  mutable std::mutex mutex_;  // of all members above and below
  std::condition_variable wake_;
  bool is_ending_ = false;
  std::thread thread_;
};

}  // namespace swarm::planner
