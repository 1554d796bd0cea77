// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "synthetic_run.hpp"

#include <atomic>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "swarm_core/robot_log/robot_log_file.hpp"

namespace swarm::monitor {
namespace {

constexpr const char* kMission = R"(version: 1
name: synthetic
world:
  bounds_m: [0, 0, 40, 20]
  obstacles:
    - circle_m: {center: [20, 10], radius: 2}
start: [{mean_m: [5, 10], covariance_m2: [[4, 0], [0, 4]], weight: 1}]
goal:
  - {mean_m: [30, 5], covariance_m2: [[1, 0], [0, 1]], weight: 0.5}
  - {mean_m: [30, 15], covariance_m2: [[1, 0], [0, 1]], weight: 0.5}
)";

}  // namespace

UtcTime at_s(double time_s) {
  return UtcTime(std::chrono::seconds(1'800'000'000)) + from_seconds(time_s);
}

std::vector<Vec2> straight(const Vec2& a, const Vec2& b, int n) {
  std::vector<Vec2> points;
  for (int i = 0; i <= n; ++i) points.push_back(a + (b - a) * (static_cast<double>(i) / n));
  return points;
}

SyntheticRun::SyntheticRun(std::uint32_t robots) : robots_(robots) {
  static std::atomic<int> number = 0;
  dir_ = std::filesystem::temp_directory_path() /
         ("synthetic_run_" + std::to_string(::getpid()) + "_" + std::to_string(number++));
  std::filesystem::create_directories(dir_);
  write_file("mission.resolved.yaml",
             std::string(kMission) + "robots: {count: " + std::to_string(robots) + "}\n");
}

SyntheticRun::~SyntheticRun() {
  std::error_code ignored;
  std::filesystem::remove_all(dir_, ignored);
}

void SyntheticRun::write_file(const std::string& name, const std::string& content) const {
  std::ofstream(dir_ / name, std::ios::binary) << content;
}

void SyntheticRun::write(std::uint32_t robot, const Incarnation& incarnation) const {
  auto writer = robot_log::Writer::open(robot_log::file_of(dir_, RobotId(robot)));
  ASSERT_TRUE(writer.has_value()) << writer.error().message;
  writer->append(robot_log::Header{.robot = RobotId(robot),
                                   .robots = robots_,
                                   .process_id = incarnation.process_id,
                                   .radius_m = 0.2,
                                   .stamp = at_s(incarnation.begin_s)});
  const std::size_t arrives_at =
      std::min(incarnation.arrives_at, incarnation.positions_m.size() - 1);
  double now_s = incarnation.begin_s;
  for (std::size_t k = 0; k < incarnation.positions_m.size(); ++k) {
    now_s = incarnation.begin_s + 0.1 * static_cast<double>(k);
    const RobotMode mode = k >= arrives_at               ? RobotMode::kArrived
                           : k >= incarnation.moves_from ? RobotMode::kMoving
                                                         : RobotMode::kWaiting;
    writer->append(robot_log::Step{.stamp = at_s(now_s),
                                   .position_m = incarnation.positions_m[k],
                                   .lateness_us = incarnation.lateness_us,
                                   .mode = static_cast<std::uint8_t>(mode),
                                   .goal = incarnation.goal});
  }
  robot_log::LinkStats stats{
      .stamp = at_s(now_s), .states_sent = incarnation.states_sent, .refused = incarnation.refused};
  for (const std::int64_t age : incarnation.ages_us) stats.state_age.add(age);
  writer->append(stats);
  if (incarnation.graceful) {
    writer->append(robot_log::Note{.stamp = at_s(now_s), .code = "exit", .text = "graceful end"});
  }
}

void SyntheticRun::write_good_run() const {
  for (std::uint32_t i = 0; i < robots_; ++i) {
    const double row = i / 2;
    const bool upper = i % 2 == 1;
    const Vec2 start(4.0 + row, upper ? 13.0 : 7.0);
    const Vec2 end(28.5 + row * 0.6, upper ? 15.0 : 5.0);
    write(i, {.positions_m = straight(start, end, 200),
              .goal = static_cast<std::uint8_t>(upper ? 1 : 0),
              .process_id = 1000 + i,
              .ages_us = {1000, 2000, 30'000}});
  }
}

}  // namespace swarm::monitor
