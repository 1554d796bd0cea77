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
#include "swarmflow/core/result.hpp"
#include "swarm_core/mission/link_faults.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarm_sim/simulated_network.hpp"
#include "swarm_sim/thread_pool.hpp"
#include "swarm_sim/kills.hpp"
#include "swarm_sim/recording.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"
#include "swarm_link/gate/gate.hpp"

namespace swarm::launcher {

struct SimulationOptions {
  std::uint64_t seed = 1;
  LinkFaults faults{};
  /// All robots tick at the same moment, or spread over the control period as processes are.
  bool clocks_in_step = true;
  std::size_t threads = 1;
  std::vector<Kill> kills{};
};

/// Threads that make a simulation of so many robots faster: more than one only where a control
/// period is long against waking the others.
std::size_t useful_threads(std::uint32_t robots);

/// Told what happens in a simulation.
class SimulationObserver {
 public:
  virtual ~SimulationObserver() = default;
  virtual void on_event(UtcTime, const std::string& /*source*/, bool /*warning*/,
                        const std::string& /*code*/, const std::string& /*text*/) {}
  virtual void on_plan(std::uint32_t /*version*/, const planner::PlanResult&) {}
  virtual void on_clock(const PlanClock&) {}
  virtual void on_scene(const Scene&, const SceneChange&) {}
};

/// A mission in lock-step: the agents, planner and supervisor of a real run, each a pure function
/// of what it hears, driven by a clock that waits for nobody. In each control period every robot
/// measures, receives what the network brings, decides and commands, by the loop that a process
/// runs; then what was published goes on the network. So results depend on mission and options
/// alone, not on the number of threads, to the last bit. The planner answers at once: how long it
/// thinks costs no mission time.
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

  Outcome outcome() const { return supervisor_.outcome(); }
  double mission_s() const { return supervisor_.mission_time(now_).count(); }
  /// Of the last control period.
  MissionPhase phase() const { return phase_; }
  const PlanClock& plan_clock() const { return clock_; }
  Supervisor::Counts counts() const { return supervisor_.counts(); }

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
  struct Robot {
    agent::RobotLoop loop;
    agent::SimulatedRobot body;  // by value: in the cache with the rest
    double communication_radius_m = 0.0;        // communication radius
    SteadyTime received_until;
    std::uint32_t plan_version = 0;  // that it follows
  };
  struct RobotBus;

  /// Who is ticked after a robot; null: nobody.
  struct Upcoming {
    const Robot* next;
    const Robot* second;
  };

  /// What a thread collects.
  struct Collected {
    std::vector<link::RobotStateMessage> published;
    Histogram ages;  // of the states that robots used
  };

  Simulation(const Mission& mission, planner::Planner planner, const SimulationOptions& options,
             Recording& recording, SimulationObserver& observer);

  UtcTime utc(SteadyTime t) const;
  void place(const std::vector<Vec2>& positions_m);
  void keep_planned();
  void publish();
  void supervise();
  std::optional<agent::PlanTime> plan_time(SteadyTime now) const;
  void act(const Action& action);
  void change_scene(std::span<const SceneChange> changes);
  void kill_due();
  void kill(RobotId robot);
  void respawn(RobotId robot);
  void admit_respawned();
  void coast_fallen();
  void add_bodies(std::span<const RobotId> robots);
  void clear_bodies(std::span<const RobotId> robots);
  std::size_t slot_of(std::uint32_t robot) const;
  void report_status();
  void tick_slot(std::size_t slot);
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
  bool world_moves_ = false;
  planner::PlanKeeper keeper_;
  Supervisor supervisor_;
  agent::StatusCadence cadence_;
  MissionPhase phase_ = MissionPhase::kReady;
  UtcTime stop_sent_{};  // 0: not yet
  SimulatedNetwork network_;
  link::Gate gate_;  // what receivers check, once for each published state
  ThreadPool thread_pool_;
  std::vector<Robot> robots_;
  std::vector<Rng> rngs_;                          // of each; large and rarely used
  std::vector<std::vector<std::uint32_t>> slots_;  // robots that tick together
  std::vector<Collected> collected_;               // one a thread
  std::vector<agent::NeighbourReport> sent_states_;     // what was published at a moment
  // Those who report their status out of turn. Apart from robots_: most are only looked at.
  std::vector<std::uint8_t> has_updates_;
  std::vector<std::uint8_t> dead_;        // their processes
  std::vector<std::uint32_t> fallen_;     // dead robots that their drivers have not stopped yet
  std::vector<std::uint32_t> respawned_;  // in this period
  std::size_t next_kill_ = 0;
  SteadyTime now_;
  PlanClock clock_;                 // at now_
  agent::DensityForecast density_;  // then
  std::uint64_t periods_ = 0;
  double plan_ms_ = 0.0;
  std::vector<float> step_ns_;
  double agents_s_ = 0.0;
};

}  // namespace swarm::launcher
