// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/strong_id.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::launcher {

/// Process of a run: 0 is the planner, 1 … the agents.
using ProcessIndex = StrongId<struct ProcessIndexTag, std::uint32_t>;
inline constexpr ProcessIndex kPlanner{0};

struct SupervisorOptions {
  std::uint32_t robots = 0;
  std::uint32_t per_process = 1;
  std::uint32_t remote_processes = 0;  ///< the last ones: started by other hosts
  LauncherSpec launcher;
  std::vector<ScriptEvent> script;
  Duration signal_grace = std::chrono::seconds(5);  ///< SIGINT, this, SIGTERM, this, SIGKILL
};

/// How a process ended.
struct ProcessExit {
  int code = 0;    ///< exit code; meaningless if signal != 0
  int signal = 0;  ///< signal that killed it, 0 if it ended by itself
};

/// What a robot's status said.
struct RobotReport {
  bool has_plan = false;
  bool receives_neighbours = false;  ///< everyone who stands within its communication radius
  RobotMode mode = RobotMode::kWaiting;
  bool settled = false;
  std::uint64_t scene_version = 0;  ///< that its plan was made for
  SteadyTime sent_at{};             ///< by its stamp
};

enum class EndSignal { kInterrupt, kTerminate, kKill };

struct StartProcess {
  ProcessIndex process;
};
struct SignalProcess {
  ProcessIndex process;
  EndSignal signal;
};
struct SendCommand {
  CommandKind kind;
};
struct ChangeScene {
  SceneChange change;
};
/// These robots are not received any more: their bodies become obstacles.
struct AddBodies {
  std::vector<RobotId> robots;
};
/// These are received again: their bodies are no obstacles any more.
struct ClearBodies {
  std::vector<RobotId> robots;
};
struct LogEvent {
  bool warning = false;
  std::string code;
  std::string text;
};
using Action = std::variant<StartProcess, SignalProcess, SendCommand, ChangeScene, AddBodies,
                            ClearBodies, LogEvent>;

enum class Outcome {
  kNone,       ///< still going on
  kCompleted,  ///< every robot that lives has settled
  kTimeLimit,
  kQuorumTimeout,
  kPlannerFailed,  ///< it said why; restarting would not help, or did not
  kStopped,        ///< emergency stop
  kInterrupted,    ///< SIGINT or SIGTERM to the launcher
  kAllLost,
};
std::string_view to_string(Outcome outcome);  ///< snake_case, as in summary.json

/// Decides when processes start, restart and end, and when the mission's commands go out. Pure:
/// times and observations in, actions out.
///
/// Ready is a robot that was received, has the plan, and hears its neighbours.
///
///   starting ──last start──▶ gathering ──everyone ready──▶ running ──settled, limit, stop──▶
///   ending ──▶ done
///      └──────────── interrupt, planner cannot plan, quorum time-out ─────────────────────────▲
class Supervisor {
 public:
  enum class Stage { kStarting, kGathering, kRunning, kEnding, kDone };

  Supervisor(const SupervisorOptions& options, SteadyTime now);

  std::uint32_t processes() const { return static_cast<std::uint32_t>(processes_.size()); }
  /// First robot and number of robots of an agent process; of the planner none.
  std::pair<RobotId, std::uint32_t> robots_of(ProcessIndex process) const;

  void on_status(RobotId robot, const RobotReport& report);
  /// Another host has started some of its processes.
  void on_joined(ProcessIndex first, std::uint32_t count, SteadyTime now);
  void on_exit(ProcessIndex process, const ProcessExit& exit, SteadyTime now);
  /// A robot is not received any more, whatever became of its process: it stays where it is, in
  /// everyone's way, until it reports again.
  void on_silent(RobotId robot, SteadyTime now);
  void on_command(CommandKind kind, SteadyTime now);  ///< of the user
  /// The swarm has a new goal: who arrives by a plan for an older scene has not arrived.
  void on_new_goal(std::uint64_t scene_version) { goal_version_ = scene_version; }
  void on_interrupt();  ///< the second one kills

  /// What to do now. Call it often (every 50 ms or so).
  std::vector<Action> step(SteadyTime now);

  Stage stage() const { return stage_; }
  Outcome outcome() const { return outcome_; }
  MissionPhase phase() const { return phase_; }

  struct Counts {
    std::uint32_t started = 0, ready = 0, arrived = 0, settled = 0, stopped = 0, lost = 0;
  };
  Counts counts() const;
  /// Robots that live and have not confirmed an emergency stop.
  std::vector<RobotId> unstopped() const;
  std::vector<RobotId> lost() const;

  /// From the last start of a process to everyone being heard and having the plan; negative if that
  /// never happened.
  double discovery_s() const { return discovery_s_; }
  /// From then on to everyone hearing its neighbours as well; negative if that never happened.
  double neighbour_discovery_s() const { return neighbour_discovery_s_; }
  /// Mission time, 0 before the start.
  MissionTime mission_time(SteadyTime now) const;

 private:
  struct Process {
    bool alive = false;
    bool started = false;
    SteadyTime started_at;
    std::uint32_t respawns = 0;
    SteadyTime respawn_at;
    bool respawn_due = false;
  };
  struct Robot {
    RobotReport report;
    bool received = false;
    bool lost = false;
    std::optional<SteadyTime> silent_since{};  // its body is an obstacle
  };

  bool is_remote(ProcessIndex process) const { return process.value() >= local_processes(); }
  std::uint32_t local_processes() const { return processes() - options_.remote_processes; }
  bool is_starting(std::uint32_t process, SteadyTime now) const;
  void start_due(SteadyTime now, std::vector<Action>& actions);
  void gather(SteadyTime now, std::vector<Action>& actions);
  void run(SteadyTime now, std::vector<Action>& actions);
  void play_script(SteadyTime now, std::vector<Action>& actions);
  bool script_moves_on() const;
  bool has_newest_goal(const Robot& robot) const {
    return robot.report.scene_version >= goal_version_;
  }
  /// Stopped itself, for its control method failed: it will not arrive.
  bool has_failed(const Robot& robot) const {
    return robot.report.mode == RobotMode::kStopped && phase_ != MissionPhase::kStopped;
  }
  void repeat_stop(SteadyTime now, std::vector<Action>& actions);
  void begin_ending(Outcome outcome, SteadyTime now);
  void end(SteadyTime now, std::vector<Action>& actions);
  void command(CommandKind kind, SteadyTime now, std::vector<Action>& actions);
  void keep_bodies(std::vector<Action>& actions);

  SupervisorOptions options_;
  Stage stage_ = Stage::kStarting;
  Outcome outcome_ = Outcome::kNone;
  MissionPhase phase_ = MissionPhase::kReady;
  std::vector<Process> processes_;
  std::vector<Robot> robots_;
  std::vector<LogEvent> pending_log_;
  std::vector<CommandKind> pending_commands_;
  std::vector<RobotId> fallen_;  // since the last step
  std::vector<RobotId> risen_;
  std::uint32_t next_start_ = 0;
  SteadyTime begun_;
  SteadyTime last_start_;
  SteadyTime started_at_;  // of the mission
  SteadyTime all_arrived_at_;
  bool all_arrived_ = false;
  double discovery_s_ = -1.0;
  double neighbour_discovery_s_ = -1.0;
  std::size_t next_script_ = 0;
  std::uint64_t goal_version_ = 0;
  std::uint32_t stops_to_send_ = 0;
  SteadyTime next_stop_;
  SteadyTime stop_ends_;
  std::uint32_t interrupts_ = 0;
  SteadyTime ending_since_;
  std::uint32_t signals_sent_ = 0;
};

/// "3, 7, 12-15" for people; of many ranges the first, "and 51 more".
std::string describe(const std::vector<RobotId>& robots);

}  // namespace swarm::launcher
