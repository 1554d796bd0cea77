// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_link/gate/gate.hpp"
#include "swarm_link/gate/waiting_plan.hpp"
#include "swarm_monitor/recording/bus_tap.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/observe/observer.hpp"

namespace swarm::monitor {

/// How stamps of a run are to be taken.
inline link::Stamps stamps_of(const shell::RunInfo& run) {
  return run.is_replay ? link::Stamps::kRecorded : link::Stamps::kLive;
}

/// Decodes samples of the bus, passes them through the gate and reports the accepted ones to an
/// observer. Of a run in progress it follows the planner that the robots follow; of a replay, whose
/// states may be of any age, the one that began last. Pure: samples and time are arguments.
class BusReader {
 public:
  /// The observer outlives it. `stamps`: see stamps_of().
  BusReader(const Mission& mission, Observer& observer, link::Stamps stamps);

  /// Decodes and checks one sample; what is refused is counted and goes no further.
  void take(const TappedSample& sample);

  const link::RefusalCounters& refused() const { return gate_.refused(); }

 private:
  template <class M>
  bool decode(const TappedSample& sample, M& out);
  void take_states(const TappedSample& sample);
  void take_status(const TappedSample& sample);
  void take_plan(const TappedSample& sample);
  void take_plan(link::PlanMessage message, UtcTime received);
  void take_scene(const TappedSample& sample);
  void take_heartbeat(const TappedSample& sample);
  void take_command(const TappedSample& sample);
  void take_event(const TappedSample& sample);

  link::Gate gate_;
  Observer& observer_;
  FlowPlan plan_;
  link::WaitingPlan waiting_plan_;
  std::uint64_t undecodable_ = 0;
  link::CellStatesMessage states_;  // kept for their memory
  link::StatusMessage status_;
};

}  // namespace swarm::monitor
