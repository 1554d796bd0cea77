// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "planner_service/keeper/plan_keeper.hpp"
#include "robot_agent/drivers/simulated_robot.hpp"
#include "robot_agent/loop/density_forecast.hpp"
#include "robot_agent/loop/robot_loop.hpp"
#include "robot_agent/loop/status_cadence.hpp"
#include "swarm_core/mission/link_faults.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"
#include "swarm_link/gate/gate.hpp"
#include "swarm_sim/kills.hpp"
#include "swarm_sim/recording.hpp"
#include "swarm_sim/simulated_network.hpp"
#include "swarm_sim/thread_pool.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::launcher {

/// What a simulation depends on besides its mission.
struct SimulationOptions {
  std::uint64_t seed = 1;
  LinkFaults faults{};
  /// All robots tick at the same moment, or spread over the control period as processes are.
  bool clocks_in_step = true;
  std::size_t threads = 1;
  std::vector<Kill> kills{};
};

/// The number of threads that is fastest for a number of robots: more than one only where a control
/// period takes long compared with waking a thread.
std::size_t useful_threads(std::uint32_t robots);

/// Receives the events of a simulation, as they happen; all on the thread that calls step().
class SimulationObserver {
 public:
  virtual ~SimulationObserver() = default;
  /// What the event log of a real run would have.
  virtual void on_event(UtcTime, const std::string& /*source*/, bool /*warning*/,
                        const std::string& /*code*/, const std::string& /*text*/) {}
  /// A plan that is published; versions ascend from 1.
  virtual void on_plan(std::uint32_t /*version*/, const planner::PlanResult&) {}
  virtual void on_clock(const PlanClock&) {}
  /// A change of the scene, and the scene after it.
  virtual void on_scene(const Scene&, const SceneChange&) {}
};

/// A mission in lock-step: the agents, planner and supervisor of a real run, each a pure function
/// of its inputs, driven by a simulated clock that runs as fast as they compute. In each control
/// period every robot measures, receives what the network brings, decides and commands, by the loop
/// that a process runs; then what was published goes on the network. Results depend on mission and
/// options alone, to the last bit, and not on the number of threads. Planning takes no mission
/// time.
class Simulation {
 public:
  /// Places the robots and plans. Mission and observer outlive the simulation.
  static Result<std::unique_ptr<Simulation>> make(const Mission& mission,
                                                  const SimulationOptions& options,
                                                  Recording& recording,
                                                  SimulationObserver& observer);

  /// Runs one control period. False when the mission is over.
  bool step();

  /// Ends the mission early, as SIGINT would.
  void interrupt() { supervisor_.on_interrupt(); }

  /// The planning method of the mission.
  const planner::PlanningMethod& planning_method() const { return keeper_.method(); }

  /// How the mission ended, once step() has returned false.
  Outcome outcome() const { return supervisor_.outcome(); }
  double mission_s() const { return supervisor_.mission_time(now_).count(); }
  /// Of the last control period.
  MissionPhase phase() const { return phase_; }
  const PlanClock& plan_clock() const { return clock_; }
  Supervisor::Counts counts() const { return supervisor_.counts(); }

  /// Computing time.
  struct Cost {
    double plan_ms = 0.0;  ///< of all plans together
    std::uint64_t agent_steps = 0;
    double agents_s = 0.0;        ///< in agent steps, wall time
    double median_step_ns = 0.0;  ///< per agent, over the control periods
  };
  Cost cost() const;

  /// The simulated UTC at which every mission begins: the same run gives the same bytes.
  static UtcTime begin_utc();

 private:
  /// One robot of the simulation.
  struct Robot {
    agent::RobotLoop loop;
    agent::SimulatedRobot body;           // by value: in the cache with the rest
    double communication_radius_m = 0.0;  // its own, or the mission's
    SteadyTime received_until;
    std::uint32_t plan_version = 0;  // that it follows
    bool repeats_plan = false;       // it is offered that version again at its next tick
  };
  /// The bus interface that RobotLoop::step() takes, on the simulated network.
  struct RobotBus;

  /// The robots ticked after a robot by the same thread, to be prefetched; null: none.
  struct Upcoming {
    const Robot* next;
    const Robot* second;
  };

  /// The output of the robots that a thread ticks.
  struct Collected {
    std::vector<link::RobotStateMessage> published;
    Histogram ages;  // of the states that robots used
  };

  Simulation(const Mission& mission, planner::Planner planner, const SimulationOptions& options,
             Recording& recording, SimulationObserver& observer);

  /// Simulated UTC of a simulated steady time.
  UtcTime utc(SteadyTime t) const;
  /// Makes the robots at these positions, and assigns them to slots.
  void place(const std::vector<Vec2>& positions_m);
  void keep_planned();
  void repeat_plan();
  void publish();
  /// Has the supervisor decide, and carries out its actions.
  void supervise();
  /// The plan time within this control period; empty before the first plan.
  std::optional<agent::PlanTime> plan_time(SteadyTime now) const;
  void act(const Action& action);
  void change_scene(std::span<const SceneChange> changes);
  void kill_due();
  void kill(RobotId robot);
  /// Starts the process of a dead robot again, see admit_respawned().
  void respawn(RobotId robot);
  void admit_respawned();
  /// Bodies of killed robots until their watchdogs and brakes have stopped them.
  void coast_fallen();
  void add_bodies(std::span<const RobotId> robots);
  void clear_bodies(std::span<const RobotId> robots);
  /// The slot of the control period in which a robot ticks.
  std::size_t slot_of(std::uint32_t robot) const;
  void report_status();
  void tick_slot(std::size_t slot);
  /// Brings a robot into the cache, but not what it points to.
  static void prefetch(const Robot& robot);
  agent::RobotTick tick_at(SteadyTime now) const;
  std::optional<agent::OfferedPlan> offered_plan(const Robot& robot) const;
  void tick_robot(std::uint32_t id, const agent::RobotTick& tick, const Upcoming& upcoming,
                  Collected& collected);
  void deliver_published(SteadyTime now);
  void count_states(const Robot& robot);

  const Mission& mission_;
  SimulationOptions options_;
  Recording& recording_;
  SimulationObserver& observer_;
  Duration period_;
  World world_;
  Scene scene_;
  // Whether the map is to be rebuilt: the scene has changed, or an obstacle is moving.
  bool world_moves_ = false;
  // The programs of a real run besides the robots: planner, and launcher with its status cadence.
  planner::PlanKeeper keeper_;
  Supervisor supervisor_;
  agent::StatusCadence cadence_;
  MissionPhase phase_ = MissionPhase::kReady;
  UtcTime stop_sent_{};  // stamp of the stop command; 0: none yet
  SimulatedNetwork network_;
  link::Gate gate_;  // what receivers check, once for each published state
  ThreadPool thread_pool_;
  std::vector<Robot> robots_;
  std::vector<Rng> rngs_;                            // of each; large and rarely used
  std::vector<std::vector<std::uint32_t>> slots_;    // robots that tick together
  std::vector<Collected> collected_;                 // one a thread
  std::vector<agent::NeighbourReport> sent_states_;  // states published at a moment
  // Robots that report their status out of turn. Apart from robots_: a pass over all of them reads
  // little memory.
  std::vector<std::uint8_t> has_updates_;
  std::vector<std::uint8_t> dead_;        // their processes
  std::vector<std::uint32_t> fallen_;     // dead robots that their drivers have not stopped yet
  std::vector<std::uint32_t> respawned_;  // in this period
  // Index of the first kill that is not due yet; kills are sorted by time.
  std::size_t next_kill_ = 0;
  // Begin of the present control period.
  SteadyTime now_;
  PlanClock clock_;  // at now_
  // When robots are offered the newest plan again, unless a new one is published before.
  std::optional<SteadyTime> repeat_plan_at_;
  agent::DensityForecast density_;  // then
  // Measured cost: control periods run, time of planning, wall time per agent and step.
  std::uint64_t periods_ = 0;
  double plan_ms_ = 0.0;
  std::vector<float> step_ns_;
  double agents_s_ = 0.0;
};

}  // namespace swarm::launcher
