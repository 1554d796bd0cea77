// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// One mission flown twice: by the simulation, and by the agent process over the in-process bus
// under a manual clock, led by the simulation's planner. Their robots must log the same bytes.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "robot_agent/program/process_loop.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarm_link/to_message.hpp"
#include "swarm_sim/simulation.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "tests/support/inproc/inproc_bus.hpp"

namespace swarm::agent {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kRobots = 3;
constexpr std::uint64_t kSeed = 5;
constexpr int kTicks = 130;
constexpr Duration kPeriod = std::chrono::milliseconds(100);

/// Noise in motion and measurement; all robots receive each other all the time.
Mission noisy_mission() {
  auto mission = load_mission(fs::path(SWARM_SOURCE_DIR) / "deploy/missions/small.yaml");
  EXPECT_TRUE(mission.has_value());
  mission->robots.count = kRobots;
  mission->robots.motion_noise_m = 0.005;
  mission->robots.position_noise_m = 0.01;
  mission->link.communication_radius_m = 60.0;
  mission->script = {{.at_s = 9.0, .action = CommandKind::kStop}};
  return *std::move(mission);
}

/// What the planner and the launcher of a run send, with the content of the simulation.
class Ground final : public launcher::SimulationObserver {
 public:
  explicit Ground(link::InprocBus& bus) : participant_(bus.make_participant()) {
    plan_ = *participant_->make_writer(link::plan_topic());
    heartbeat_ = *participant_->make_writer(link::heartbeat_topic());
    command_ = *participant_->make_writer(link::command_topic());
  }

  void on_plan(std::uint32_t version, const planner::PlanResult& planned) override {
    plan_->write(link::to_message(planned.plan, PlannerEpoch(epoch()), PlanVersion(version),
                                  launcher::Simulation::begin_utc()));
  }

  /// After a step of the simulation, before the process makes the same.
  void send(const launcher::Simulation& simulation, UtcTime utc_now) {
    const std::int64_t stamp = utc_now.time_since_epoch().count();
    const PlanClock& clock = simulation.plan_clock();
    heartbeat_->write({.phase = simulation.phase(),
                       .version = clock.plan_version,
                       .epoch = epoch(),
                       .sequence_number = ++beats_,
                       .stamp_utc_ns = stamp,
                       .plan_time_s = clock.plan_time_s,
                       .plan_rate = clock.rate});
    if (simulation.phase() == phase_) return;
    phase_ = simulation.phase();
    command_->write(
        {.kind = phase_ == MissionPhase::kStopped ? CommandKind::kStop : CommandKind::kStart,
         .command_id = static_cast<std::uint64_t>(stamp),
         .stamp_utc_ns = stamp});
  }

 private:
  static std::uint64_t epoch() {
    return static_cast<std::uint64_t>(launcher::Simulation::begin_utc().time_since_epoch().count());
  }

  std::unique_ptr<link::Participant> participant_;
  link::WriterPtr<link::PlanMessage> plan_;
  link::WriterPtr<link::HeartbeatMessage> heartbeat_;
  link::WriterPtr<link::CommandMessage> command_;
  MissionPhase phase_ = MissionPhase::kReady;
  std::uint64_t beats_ = 0;
};

/// A folder for this test, removed with the object.
struct Folder {
  explicit Folder(const std::string& name)
      : path(fs::temp_directory_path() / (name + "-" + std::to_string(::getpid()))) {
    fs::create_directories(path / "blackbox");
  }
  ~Folder() { fs::remove_all(path); }
  fs::path path;
};

struct FlownTwice {
  Folder simulated{"swarm-same-simulated"};
  Folder processed{"swarm-same-process"};
};

void fly(const Mission& mission, const FlownTwice& flown) {
  link::InprocBus bus;
  Ground ground(bus);
  launcher::Recording recording(mission, launcher::Simulation::begin_utc(), 1);
  auto simulation = launcher::Simulation::make(mission, {.seed = kSeed}, recording, ground);
  ASSERT_TRUE(simulation.has_value()) << simulation.error().message;

  SteadyTime now{std::chrono::seconds(77)};
  UtcTime utc_now = launcher::Simulation::begin_utc();
  auto world = std::make_unique<World>(mission.world);
  shell::FileThread files;
  auto robots = make_local_robots(mission, *world, builtin_robots(),
                                  {.files = files,
                                   .run_dir = flown.processed.path,
                                   .first = RobotId(0),
                                   .count = kRobots,
                                   .seed = kSeed,
                                   .now = now,
                                   .utc_now = utc_now});
  ASSERT_TRUE(robots.has_value()) << robots.error().message;
  auto access = open_endpoints(bus.make_participant());
  ASSERT_TRUE(access.has_value()) << access.error().message;
  open_topic_channel(*access, mission.link);
  access->states->listen_around(std::vector<Vec2>{{5.0, 5.0}});  // cells are discovered already
  ProcessLoop process(mission, std::move(world), *std::move(robots), *std::move(access));

  for (int k = 0; k < kTicks && (*simulation)->step(); ++k) {
    ground.send(**simulation, utc_now);
    process.tick({.now = now, .utc_now = utc_now});
    now += kPeriod;
    utc_now += kPeriod;
  }
  process.end({.now = now, .utc_now = utc_now});
  EXPECT_TRUE(files.finish().empty());
  const auto written = recording.write(flown.simulated.path);
  ASSERT_TRUE(written.has_value()) << written.error().message;
}

/// Whether the loop of a robot records this, and not the process or the simulation around it.
bool is_of_loop(const robot_log::Record& record) {
  if (const auto* note = std::get_if<robot_log::Note>(&record)) {
    return note->code == "plan" || note->code == "mode";
  }
  return std::holds_alternative<robot_log::Step>(record) ||
         std::holds_alternative<robot_log::Estimate>(record);
}

struct LoopLog {
  std::string bytes;
  std::size_t steps = 0, estimates = 0, notes = 0;
  RobotMode last_mode = RobotMode::kWaiting;
};

/// What the loop recorded, as a file's bytes.
LoopLog loop_log(const fs::path& run_dir, RobotId robot) {
  LoopLog log;
  robot_log::Batch batch;
  batch.append(robot_log::Header{.robot = robot});
  const auto read = robot_log::read_records(
      robot_log::file_of(run_dir, robot), [&](const robot_log::Record& record) {
        if (!is_of_loop(record)) return;
        log.steps += std::holds_alternative<robot_log::Step>(record);
        log.estimates += std::holds_alternative<robot_log::Estimate>(record);
        log.notes += std::holds_alternative<robot_log::Note>(record);
        if (const auto* step = std::get_if<robot_log::Step>(&record)) {
          log.last_mode = static_cast<RobotMode>(step->mode);
        }
        batch.append(record);
      });
  EXPECT_TRUE(read.has_value());
  const fs::path file = run_dir / "loop.mcap";
  EXPECT_TRUE(batch.write(file).has_value());
  std::ifstream in(file, std::ios::binary);
  log.bytes.assign(std::istreambuf_iterator<char>(in), {});
  return log;
}

TEST(SameRobot, LogsTheSameBytesInProcessAndSimulation) {
  const Mission mission = noisy_mission();
  const FlownTwice flown;
  ASSERT_NO_FATAL_FAILURE(fly(mission, flown));

  for (std::uint32_t i = 0; i < kRobots; ++i) {
    const LoopLog simulated = loop_log(flown.simulated.path, RobotId(i));
    const LoopLog processed = loop_log(flown.processed.path, RobotId(i));

    EXPECT_GE(simulated.steps, 100U);
    EXPECT_EQ(simulated.last_mode, RobotMode::kStopped);
    EXPECT_EQ(simulated.steps, processed.steps);
    EXPECT_EQ(simulated.estimates, processed.estimates);
    EXPECT_EQ(simulated.notes, processed.notes);
    EXPECT_TRUE(simulated.bytes == processed.bytes) << "robot " << i;
  }
}

}  // namespace
}  // namespace swarm::agent
