// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include "robot_agent/program/local_robot.hpp"
#include "tests/unit/robot_agent/inbox_bench.hpp"

/// The robots of a process with an inbox that a test fills, without a bus.
namespace swarm::agent {

/// Keeps what is written.
template <class M>
class KeepingWriter final : public link::Writer<M> {
 public:
  bool write(const M& message) override {
    written.push_back(message);
    return true;
  }
  int matched() const override { return 1; }
  std::vector<M> take() { return std::exchange(written, {}); }
  std::vector<M> written;
};

/// A body at rest whose position a test makes invalid.
class StandingDriver final : public Driver {
 public:
  Measurement measure(SteadyTime) override {
    Measurement m;
    m.position_m = {5, 5};
    m.is_valid = is_valid;
    return m;
  }
  void command(SteadyTime, const Vec2&, Duration) override {}
  bool is_valid = true;
};

/// Delivers nothing and sends nothing.
struct NoBus {
  template <class Take>
  void receive(const Vec2&, Take) {}
  void publish(const link::RobotStateMessage&) {}
};

class ProcessBench : public InboxBench {
 protected:
  explicit ProcessBench(std::uint32_t robots)
      : folder_(std::filesystem::temp_directory_path() /
                ("process_bench_" + std::to_string(::getpid()) + "_" +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    mission_.robots.count = robots;
    robots_.reserve(robots);
    for (std::uint32_t i = 0; i < robots; ++i) {
      const RobotId id(i);
      robots_.push_back(
          {.loop = RobotLoop(world_, agent_options(mission_, id), agent_identity(mission_, id)),
           .driver = std::make_unique<StandingDriver>(),
           .rng = Rng(i),
           .log = LogFile(robot_log::Writer::open(log_of(id)).value(), id, nullptr)});
    }
  }
  ~ProcessBench() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::filesystem::path log_of(RobotId id) const { return robot_log::file_of(folder_, id); }

  /// One control step of a robot, with nothing received.
  void step(std::uint32_t robot, MissionPhase phase = MissionPhase::kReady) {
    NoBus bus;
    LocalRobot& r = robots_[robot];
    r.loop.step({.now = steady(),
                 .utc_now = utc(),
                 .period = milliseconds(100),
                 .phase = phase,
                 .planner_alive = true},
                {.driver = *r.driver, .rng = r.rng, .log = r.log}, bus);
  }
  StandingDriver& driver(std::uint32_t robot) {
    return dynamic_cast<StandingDriver&>(*robots_[robot].driver);
  }

  Mission mission_;
  World world_ = World::make({{0, 0}, {20, 10}}, {}).value();
  std::filesystem::path folder_;
  std::vector<LocalRobot> robots_;
  Histogram ages_;
};

}  // namespace swarm::agent
