// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_launcher/flight/flight_loop.hpp"
#include "swarm_link/monitor_topics.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "tests/support/inproc/inproc_bus.hpp"
#include "tests/unit/swarm_launcher/flight/fake_ports.hpp"

namespace swarm::launcher {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A directory of one test.
class TemporaryDir {
 public:
  TemporaryDir() { std::filesystem::create_directories(path); }
  ~TemporaryDir() { std::filesystem::remove_all(path); }
  TemporaryDir(const TemporaryDir&) = delete;
  TemporaryDir& operator=(const TemporaryDir&) = delete;

  const std::filesystem::path path =
      std::filesystem::temp_directory_path() /
      ("flight-" + std::to_string(::getpid()) + "-" +
       ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

/// The bus as robots, planner and monitors see it.
struct OtherSide {
  explicit OtherSide(link::InprocBus& bus)
      : participant(bus.make_participant()),
        statuses(*participant->make_writer(link::status_topic())),
        events(*participant->make_writer(link::event_topic())),
        heartbeats(*participant->make_writer(link::heartbeat_topic())),
        commands(*participant->make_reader(link::command_topic())),
        scenes(*participant->make_reader(link::scene_topic())),
        relayed_statuses(*participant->make_reader(link::relayed_status_topic())),
        relayed_events(*participant->make_reader(link::relayed_event_topic())) {}

  std::unique_ptr<link::Participant> participant;
  link::WriterPtr<link::StatusMessage> statuses;
  link::WriterPtr<link::EventMessage> events;
  link::WriterPtr<link::HeartbeatMessage> heartbeats;
  link::ReaderPtr<link::CommandMessage> commands;
  link::ReaderPtr<link::SceneMessage> scenes;
  link::ReaderPtr<link::StatusMessage> relayed_statuses;
  link::ReaderPtr<link::EventMessage> relayed_events;
};

/// A robot that obeys commands; it reports while its process runs.
struct FakeRobot {
  RobotMode mode = RobotMode::kWaiting;
  bool settled = false;
  bool silent = false;           ///< its statuses do not get through
  std::uint64_t command_id = 0;  ///< of the newest command that it obeys
  bool ignores_stop = false;
  std::uint64_t scene_version = 0;  ///< that its plan was made for, if newer than the launcher's
  link::Writer<link::StatusMessage>* statuses = nullptr;  ///< null: the one that all share
};

/// Flies a mission of three robots, one per process, with a manual clock: no process, no waiting.
class FlightBench : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kRobots = 3;

  FlightBench() : others(bus) {
    auto loaded = load_mission(std::string(SWARM_SOURCE_DIR) + "/deploy/missions/small.yaml");
    options.mission = std::move(*loaded);
    options.mission.robots.count = kRobots;
    options.how.agent_program = "agent";
    options.how.planner_program = "planner";
  }

  /// Call it after the options were changed; the first step does it otherwise.
  void begin() {
    own = bus.make_participant();
    launcher_bus.emplace(*open_launcher_bus(*own, link::wire_limits(options.mission)));
    scene.emplace(options.mission.world, append_to_file(dir.path / shell::kSceneFile),
                  std::move(launcher_bus->scenes));
    event_log.emplace(append_to_file(dir.path / shell::kEventsFile));
    log.emplace(*event_log, *launcher_bus->event_relay, display);
    loop.emplace(options, dir.path,
                 FlightPorts{.spawner = spawner,
                             .bus = *launcher_bus,
                             .scene = *scene,
                             .control = requests,
                             .helpers = helpers,
                             .log = *log,
                             .display = display,
                             .recorded = {.last_step = [](RobotId) { return std::nullopt; },
                                          .in_log = [](RobotId) { return std::nullopt; }},
                             .beats = beat_sender ? &*beat_sender : nullptr},
                 now.steady);
  }

  /// One period of the launcher. Robots obey what was published in the period before.
  void step() {
    if (!loop) begin();
    obey();
    if (now.steady >= next_report) {
      report();
      next_report = now.steady + milliseconds(200);
    }
    if (const auto stepped = loop->step(now); !stepped) error = stepped.error().message;
    now.steady += milliseconds(20);
    now.utc += milliseconds(20);
  }
  void run_for(Duration span) {
    for (const SteadyTime until = now.steady + span; now.steady < until;) step();
  }
  /// False if the condition did not become true within the time.
  bool run_until(const std::function<bool()>& condition, Duration limit = seconds(60)) {
    if (!loop) begin();
    for (const SteadyTime until = now.steady + limit; now.steady < until && !condition();) step();
    return condition();
  }
  bool run_to_phase(MissionPhase phase) {
    return run_until([&] { return loop->supervisor().phase() == phase; });
  }
  bool run_to_the_end() {
    return run_until([&] { return loop->is_done(); });
  }
  /// All robots that have obeyed what was published so far reach the goal.
  void arrive() {
    run_for(milliseconds(100));
    for (FakeRobot& robot : robots) {
      robot.mode = RobotMode::kArrived;
      robot.settled = true;
    }
  }

  /// Whether the event log has a line with this code.
  bool is_logged(const std::string& code) const {
    const auto text = shell::read_file(dir.path / shell::kEventsFile, 1U << 20U);
    return text && text->find("\"code\":\"" + code + "\"") != std::string::npos;
  }
  Outcome outcome() const { return loop->supervisor().outcome(); }
  std::size_t sent(CommandKind kind) const {
    return static_cast<std::size_t>(
        std::count_if(commands.begin(), commands.end(),
                      [&](const link::CommandMessage& command) { return command.kind == kind; }));
  }

  FlightTime now{.steady = SteadyTime(seconds(1000)), .utc = UtcTime(seconds(1'800'000'000))};
  FlightOptions options;
  TemporaryDir dir;
  link::InprocBus bus;
  OtherSide others;
  FakeSpawner spawner;
  FakeRequests requests;
  std::optional<BeatSender> beat_sender;  ///< empty: the launcher sends none
  FakeHelpers helpers;
  FakeDisplay display;
  std::vector<FakeRobot> robots{kRobots};
  std::vector<link::CommandMessage> commands;  ///< all that the robots received
  std::string error;                           ///< of the last step that failed

  std::unique_ptr<link::Participant> own;
  std::optional<LauncherBus> launcher_bus;
  std::optional<SceneKeeper> scene;
  std::optional<EventLog> event_log;
  std::optional<FlightLog> log;
  std::optional<FlightLoop> loop;

 private:
  /// All robots obey the commands that were published since the last call.
  void obey() {
    const std::size_t known = commands.size();
    others.commands->take(commands);
    for (std::size_t i = known; i < commands.size(); ++i) {
      for (FakeRobot& robot : robots) {
        if (commands[i].kind != CommandKind::kStop || !robot.ignores_stop) {
          robot.command_id = std::max(robot.command_id, commands[i].command_id);
        }
        if (commands[i].kind == CommandKind::kStart) robot.mode = RobotMode::kMoving;
        if (commands[i].kind == CommandKind::kPause && robot.mode == RobotMode::kMoving) {
          robot.mode = RobotMode::kHolding;
        }
        if (commands[i].kind == CommandKind::kResume && robot.mode == RobotMode::kHolding) {
          robot.mode = RobotMode::kMoving;
        }
        if (commands[i].kind == CommandKind::kStop && !robot.ignores_stop) {
          robot.mode = RobotMode::kStopped;
        }
      }
    }
  }

  /// Each agent process that runs publishes the status of its robot, which has a plan.
  void report() {
    for (const FakeChild& child : spawner.children) {
      if (child.is_planner() || !child.runs || robots[child.first_robot()].silent) continue;
      const std::uint32_t id = child.first_robot();
      auto& writer = robots[id].statuses != nullptr ? *robots[id].statuses : *others.statuses;
      writer.write(
          {.first_robot_id = id,
           .plan_version = 1,
           .plan_scene_version = std::max(scene->scene().version, robots[id].scene_version),
           .command_id = robots[id].command_id,
           .stamp_utc_ns = now.utc.time_since_epoch().count(),
           .robots = {{.robot_id = id,
                       .mode = robots[id].mode,
                       .settled = robots[id].settled,
                       .x_m = 5.0 + id,
                       .y_m = 5.0,
                       .neighbours_heard = kRobots - 1,
                       .ticks = 1}}});
    }
  }

  SteadyTime next_report;
};

}  // namespace swarm::launcher
