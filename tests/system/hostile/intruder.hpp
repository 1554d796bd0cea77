// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_link/channels/groups/rtps_datagram.hpp"
#include "swarm_link/port.hpp"
#include "tests/conformance/receivers/receiver.hpp"
#include "tests/system/flown_run.hpp"

namespace swarm::test {

/// Now, as messages have it.
std::int64_t utc_ns();

/// A participant on the bus of a run that is no part of it. With a
/// discovery server it joins like any other, with Fast DDS; else with Cyclone DDS, which it points
/// at every UDP port of the processes.
Result<std::unique_ptr<link::Participant>> intrude(const FlownRun& run);

/// Such a participant that sends whatever it is given to all processes of a
/// run, and receives statuses, heartbeats and commands. Without a discovery server it sends states
/// to the groups, too.
class Intruder {
 public:
  /// Fails the test if it cannot join.
  explicit Intruder(const FlownRun& run);
  ~Intruder();

  /// Whether this number of agents with one robot each, planner and launcher are matched, and their
  /// statuses, heartbeats and commands received. Call it until then, before the first write().
  bool is_in(int agents);

  /// False if the message cannot be put into bytes.
  bool write(const link::conformance::AnyMessage& message);

  /// Takes what has arrived.
  void look();
  /// Of the planner whose heartbeat came last; 0: none yet.
  std::uint64_t planner_epoch() const { return epoch_; }
  std::optional<MissionPhase> phase() const { return phase_; }
  /// The newest command.
  const link::CommandMessage& command() const { return command_; }
  /// Robots whose last status has this mode.
  long robots_in(RobotMode mode) const;

 private:
  struct Writers {
    link::WriterPtr<link::PlanMessage> plan;
    link::WriterPtr<link::SceneMessage> scene;
    link::WriterPtr<link::HeartbeatMessage> heartbeat;
    link::WriterPtr<link::CommandMessage> command;
    link::WriterPtr<link::StatusMessage> status;
    link::WriterPtr<link::EventMessage> event;
    link::WriterPtr<link::CellStatesMessage> cell;
  };
  bool write(const link::CellStatesMessage& batch);
  template <class M>
  std::vector<M> take_from_others(link::Reader<M>& reader);

  shell::RunInfo run_;
  std::unique_ptr<link::Participant> participant_;
  Writers writers_;
  link::ReaderPtr<link::HeartbeatMessage> heartbeats_;
  link::ReaderPtr<link::StatusMessage> statuses_;
  link::ReaderPtr<link::CommandMessage> commands_;
  bool has_written_ = false;
  std::set<std::uint64_t> others_;  ///< senders that were received before
  int group_socket_ = -1;
  std::uint64_t datagrams_ = 0;
  std::uint64_t epoch_ = 0;
  std::optional<MissionPhase> phase_{};
  link::CommandMessage command_{};
  std::map<std::uint32_t, RobotMode> modes_;
};

}  // namespace swarm::test
