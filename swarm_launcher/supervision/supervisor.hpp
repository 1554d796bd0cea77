// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "swarm_launcher/supervision/restart_policy.hpp"
#include "swarm_launcher/supervision/silence_watch.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/strong_id.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::launcher {

/// Index of a process of a run: 0 is the planner, 1 … the agents.
using ProcessIndex = StrongId<struct ProcessIndexTag, std::uint32_t>;
inline constexpr ProcessIndex kPlanner{0};

/// What the supervisor needs to know of a run.
struct SupervisorOptions {
  std::uint32_t robots = 0;
  std::uint32_t per_process = 1;
  std::uint32_t remote_processes = 0;  ///< number of those that other hosts start: the last ones
  LauncherSpec launcher;
  std::vector<ScriptEvent> script;
  SilenceLimits agent_silence{};                    ///< between the statuses of an agent process
  SilenceLimits planner_silence{};                  ///< between the planner's heartbeats
  Duration signal_grace = std::chrono::seconds(5);  ///< time between SIGINT, SIGTERM and SIGKILL
};

/// How a process ended.
struct ProcessExit {
  int code = 0;               ///< exit code; meaningless if signal != 0
  int signal = 0;             ///< signal that killed it, 0 if it ended by itself
  bool is_restarted = false;  ///< by the host on which it ran
};

/// The part of a robot's status that the supervisor uses.
struct RobotReport {
  bool has_plan = false;
  bool receives_neighbours = false;  ///< all robots within its communication radius
  RobotMode mode = RobotMode::kWaiting;
  bool settled = false;
  std::uint64_t scene_version = 0;  ///< scene that its plan was made for
  SteadyTime sent_at{};             ///< by its stamp, on the launcher's clock
  bool confirms_stop = false;       ///< it has obeyed the emergency stop
};

/// Signals that end a process, weakest first.
enum class EndSignal { kInterrupt, kTerminate, kKill };

/// Actions: what the caller of step() has to do, in the order given.
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
/// The bodies of these robots, which are dead or silent, become obstacles.
struct AddBodies {
  std::vector<RobotId> robots;
};
/// These robots are received again: their bodies are no longer obstacles.
struct ClearBodies {
  std::vector<RobotId> robots;
};
/// An event for the log; warnings are also shown to the user.
struct LogEvent {
  bool warning = false;
  std::string code;
  std::string text;
};
using Action = std::variant<StartProcess, SignalProcess, SendCommand, ChangeScene, AddBodies,
                            ClearBodies, LogEvent>;

/// How a run ended.
enum class Outcome {
  kNone,       ///< still going on
  kCompleted,  ///< every robot that is not lost has settled
  kTimeLimit,
  kQuorumTimeout,
  kPlannerFailed,  ///< its log has the reason; restarts cannot help or did not
  kStopped,        ///< emergency stop
  kInterrupted,    ///< SIGINT or SIGTERM to the launcher
  kAllLost,
};
std::string_view to_string(Outcome outcome);  ///< snake_case, as in summary.json

/// Decides when processes start, restart and end, and when mission commands are sent. Pure: times
/// and observations in, actions out; no clock, no processes, no bus. Not thread-safe.
///
/// A robot is ready when it is received, has the plan, and receives its neighbours.
///
///   starting ──last start──▶ gathering ──all ready──▶ running ──settled, limit, stop──▶
///   ending ──▶ done
///      └──────────── interrupt, planner cannot plan, quorum time-out ──────────────────▲
class Supervisor {
 public:
  /// Stages of a run; see above.
  enum class Stage { kStarting, kGathering, kRunning, kEnding, kDone };

  Supervisor(const SupervisorOptions& options, SteadyTime now);

  std::uint32_t processes() const { return static_cast<std::uint32_t>(processes_.size()); }
  /// Whether the process of a robot runs and a status of it has come since it fell silent, if ever.
  bool is_received(RobotId robot, SteadyTime now) const {
    const Robot& r = robots_.at(robot.value());
    return runs_for(robot, now) && r.received && !r.silent_since;
  }
  /// How long the process of a robot has been running; empty: it has ended.
  std::optional<Duration> runs_for(RobotId robot, SteadyTime now) const {
    const Process& p = process_of(robot);
    return p.alive ? std::optional(now - p.started_at) : std::nullopt;
  }
  /// First robot and number of robots of an agent process; of the planner none.
  std::pair<RobotId, std::uint32_t> robots_of(ProcessIndex process) const;

  /// A status of a robot arrived. It ends the silence of the robot only if it was sent after the
  /// silence began.
  void on_status(RobotId robot, const RobotReport& report);
  /// A robot has confirmed a stop by another path than its status.
  void on_stop_confirmed(RobotId robot) { robots_.at(robot.value()).has_stopped = true; }
  /// The process of a robot, which is its first one, reports why it cannot receive all others.
  void on_hindered(RobotId robot, const std::string& why) {
    robots_.at(robot.value()).hindrance = why;
  }
  /// A heartbeat of the planner of this epoch arrived.
  void on_heartbeat(std::uint64_t epoch);
  /// Another host has taken over `count` processes from `first` on. This gives the robots no more
  /// time to get ready: otherwise a host that joins again and again would delay the start for ever.
  void on_joined(ProcessIndex first, std::uint32_t count, SteadyTime now);
  /// A process has ended. An agent process is restarted while it died no more often in a row than
  /// the mission allows (see RestartPolicy); after that its robots are lost. The planner is
  /// restarted for as long as robots need it: without it they hold, so it never ends a mission in
  /// flight.
  void on_exit(ProcessIndex process, const ProcessExit& exit, SteadyTime now);
  /// A robot is silent: nothing is received from it, for whatever reason. It is assumed to stay
  /// where it is, as an obstacle, until it reports again.
  void on_silent(RobotId robot, SteadyTime now);
  /// A user has taken the robot away: it is no obstacle any more.
  void on_cleared(RobotId robot) { robots_.at(robot.value()).cleared = true; }
  void on_command(CommandKind kind, SteadyTime now);  ///< by the user
  /// The swarm has a new goal: robots that arrive by a plan for an older scene do not count as
  /// arrived.
  void on_new_goal(std::uint64_t scene_version) { goal_version_ = scene_version; }
  void on_interrupt();  ///< the second one kills all processes

  /// Returns the actions that are due. Call it often (every 50 ms or so).
  std::vector<Action> step(SteadyTime now);

  Stage stage() const { return stage_; }
  Outcome outcome() const { return outcome_; }
  MissionPhase phase() const { return phase_; }

  /// Processes started, and robots by state. A lost robot is in no other group.
  struct Counts {
    std::uint32_t started = 0, ready = 0, arrived = 0, settled = 0, stopped = 0, lost = 0;
  };
  Counts counts() const;
  /// Robots whose process runs and which have not confirmed an emergency stop.
  std::vector<RobotId> unstopped() const;
  /// Robots that cannot arrive any more.
  std::vector<RobotId> lost() const;
  /// Robots that are not received, no status has come yet or none since they fell silent, but for
  /// those that a user has cleared. Ascending.
  std::vector<RobotId> silent() const;
  /// Whether these are all: not right after this launcher was suspended itself.
  bool knows_silent(SteadyTime now) const;

  /// Time [s] from the last start of a process until every robot was received and had the plan;
  /// negative if that never happened.
  double discovery_s() const { return discovery_s_; }
  /// Time [s] from then until every robot received its neighbours as well; negative if that never
  /// happened.
  double neighbour_discovery_s() const { return neighbour_discovery_s_; }
  /// Mission time, which starts with the start command; 0 before.
  MissionTime mission_time(SteadyTime now) const;

 private:
  /// Life cycle of a process.
  struct Process {
    bool alive = false;
    bool started = false;
    SteadyTime started_at;
    RestartPolicy restarts{};
    SilenceWatch silence{};
    bool is_killed = false;  ///< because it was silent
    SteadyTime respawn_at;   ///< when it may be restarted
    bool respawn_due = false;
  };
  struct Robot {
    RobotReport report;
    bool has_stopped = false;  ///< confirmed the emergency stop, which is final
    bool received = false;     ///< since the last start of its process
    /// All its neighbours, at some status since all robots are known. Robots that wait make room
    /// for each other, so that those at the rim of the communication radius come and go.
    bool received_neighbours = false;
    bool absent = false;  ///< not received when the mission started, or given up
    bool lost = false;
    bool cleared = false;                      ///< by a user, since it fell silent
    std::optional<SteadyTime> silent_since{};  // its body is an obstacle
    std::string hindrance{};                   ///< last report of its process before the start
  };

  /// Whether another host starts the process.
  bool is_remote(ProcessIndex process) const { return process.value() >= local_processes(); }
  std::uint32_t local_processes() const { return processes() - options_.remote_processes; }
  Process& process_of(RobotId robot) {
    return processes_[1 + robot.value() / options_.per_process];
  }
  const Process& process_of(RobotId robot) const {
    return processes_[1 + robot.value() / options_.per_process];
  }
  bool is_starting(std::uint32_t process, SteadyTime now) const;
  /// The steps of a stage; each appends its actions.
  void start_due(SteadyTime now, std::vector<Action>& actions);
  void start(ProcessIndex process, SteadyTime now, std::vector<Action>& actions);
  void gather(SteadyTime now, std::vector<Action>& actions);
  void run(SteadyTime now, std::vector<Action>& actions);
  void play_script(SteadyTime now, std::vector<Action>& actions);
  bool script_moves_on() const;
  bool has_newest_goal(const Robot& robot) const {
    return robot.report.scene_version >= goal_version_;
  }
  /// The robot has stopped by itself because its control method failed: it will not arrive.
  bool has_failed(const Robot& robot) const {
    return robot.report.mode == RobotMode::kStopped && phase_ != MissionPhase::kStopped;
  }
  /// The robot cannot arrive: its process has ended for good or hangs, or it stopped by itself.
  bool is_out(const Robot& robot) const { return robot.lost || robot.absent || has_failed(robot); }

  /// Processes that are silent.
  const SilenceLimits& limits_of(std::uint32_t process) const {
    return process == kPlanner.value() ? options_.planner_silence : options_.agent_silence;
  }
  void watch_silence(SteadyTime now, std::vector<Action>& actions);
  void assume_still(ProcessIndex process, SteadyTime now);
  void end_silent(SteadyTime now, std::vector<Action>& actions);
  void give_up(ProcessIndex process, SteadyTime now, std::vector<Action>& actions);
  bool receives_other_hosts(SteadyTime now) const;
  Duration first_beat_timeout() const;
  static std::string_view sign_of_life(std::uint32_t process);
  std::string name_of(ProcessIndex process) const;
  void leave_out_absent(SteadyTime now);
  std::string hindrances_of(const std::vector<RobotId>& missing) const;
  void report_late_joiners(std::vector<Action>& actions);

  void hold_without_planner(std::uint32_t deaths);
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
  std::vector<RobotId> fallen_;        // since the last step
  std::vector<RobotId> risen_;         ///< received again since the last step
  std::vector<RobotId> late_joiners_;  ///< absent ones that reported since the last step
  std::uint64_t planner_epoch_ = 0;    ///< of the last heartbeat
  std::uint64_t ended_epoch_ = 0;      ///< of the last planner that ended
  std::optional<SteadyTime> stepped_at_{};
  std::optional<SteadyTime> suspended_at_{};  ///< end of its last suspension
  std::uint32_t next_start_ = 0;              ///< first process that was never started
  SteadyTime begun_;
  SteadyTime last_start_;
  SteadyTime started_at_;  // of the mission
  SteadyTime all_arrived_at_;
  bool all_arrived_ = false;
  double discovery_s_ = -1.0;
  double neighbour_discovery_s_ = -1.0;
  std::size_t next_script_ = 0;  ///< next event of the script
  std::uint64_t goal_version_ = 0;
  std::uint32_t stops_to_send_ = 0;  ///< repetitions left
  SteadyTime next_stop_;
  SteadyTime stop_ends_;
  std::uint32_t interrupts_ = 0;
  SteadyTime ending_since_;
  std::uint32_t signals_sent_ = 0;  ///< steps of the ladder done
};

/// "3, 7, 12-15" for messages; of many ranges only the first, then "and 51 more".
std::string describe(const std::vector<RobotId>& robots);

}  // namespace swarm::launcher
