// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/ros/ros_swarm.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "swarm_ros/ros_time.hpp"

namespace swarm::monitor {
namespace {

// A state older than this is not moved on: its robot may have stopped.
constexpr Duration kMostAge = std::chrono::milliseconds(500);
constexpr Duration kStale = std::chrono::seconds(3);
constexpr Duration kWarnedFor = std::chrono::seconds(10);
constexpr double kAtRest_mps = 0.01;  // has no direction
constexpr double kThin_m = 0.01;      // height of an ellipse on the ground

// visualization_msgs/Marker
constexpr std::int32_t kCylinder = 3;
constexpr std::int32_t kSphereList = 7;
// diagnostic_msgs/DiagnosticStatus
constexpr std::uint8_t kOk = 0;
constexpr std::uint8_t kWarning = 1;
constexpr std::uint8_t kStaleLevel = 3;
// nav_msgs/OccupancyGrid
constexpr std::int8_t kOccupied = 100;

ros::ColorRgba color_of(RobotMode mode) {
  switch (mode) {
    case RobotMode::kWaiting:
      return {.r = 0.6F, .g = 0.6F, .b = 0.6F, .a = 1.0F};
    case RobotMode::kMoving:
      return {.r = 0.13F, .g = 0.47F, .b = 0.85F, .a = 1.0F};
    case RobotMode::kHolding:
      return {.r = 0.95F, .g = 0.77F, .b = 0.06F, .a = 1.0F};
    case RobotMode::kArrived:
      return {.r = 0.18F, .g = 0.65F, .b = 0.29F, .a = 1.0F};
    case RobotMode::kStopped:
      break;
  }
  return {.r = 0.85F, .g = 0.15F, .b = 0.15F, .a = 1.0F};
}

ros::Quaternion yaw(double angle_rad) {
  return {.x = 0.0, .y = 0.0, .z = std::sin(angle_rad / 2), .w = std::cos(angle_rad / 2)};
}

/// A flat cylinder with the half-axes of one standard deviation.
ros::Marker ellipse(const WeightedGaussian& part) {
  const Eigen::SelfAdjointEigenSolver<Mat2> axes(part.gaussian.covariance_m2());
  const Vec2 sigma_m = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Vec2 longest = axes.eigenvectors().col(1);
  ros::Marker marker;
  marker.ns = "plan";
  marker.type = kCylinder;
  marker.pose = {.position = {.x = part.gaussian.mean_m().x(), .y = part.gaussian.mean_m().y()},
                 .orientation = yaw(std::atan2(longest.y(), longest.x()))};
  marker.scale = {.x = 2.0 * sigma_m.y(), .y = 2.0 * sigma_m.x(), .z = kThin_m};
  marker.color = {.r = 0.5F, .g = 0.3F, .b = 0.7F, .a = 0.3F};
  return marker;
}

ros::KeyValue value(std::string key, std::string text) {
  return {.key = std::move(key), .value = std::move(text)};
}

}  // namespace

void RosSwarm::on_mission(const Mission& mission) {
  mission_ = mission;
  robots_.assign(mission.robots.count, {});
  ++map_version_;
}

void RosSwarm::on_plan(const ObservedPlan& plan) {
  flow_ = plan.flow;
  plan_version_ = plan.version;
}

void RosSwarm::on_scene(const Scene& scene) {
  scene_ = scene;
  ++map_version_;
}

void RosSwarm::on_state(const ObservedState& state) {
  if (state.robot.value() >= robots_.size()) return;
  Robot& robot = robots_[state.robot.value()];
  robot.is_known = true;
  robot.position_m = state.position_m;
  robot.velocity_mps = state.velocity_mps;
  robot.as_of = state.received;
  robot.mode = state.mode;
  if (state.velocity_mps.norm() > kAtRest_mps) {
    robot.heading_rad = std::atan2(state.velocity_mps.y(), state.velocity_mps.x());
  }
}

// A robot at rest publishes few states, so its status counts for its position as well.
void RosSwarm::on_status(const ObservedStatus& status) {
  if (status.robot.value() >= robots_.size()) return;
  Robot& robot = robots_[status.robot.value()];
  if (!robot.is_known || status.received - robot.as_of > kMostAge) {
    robot.position_m = status.position_m;
    robot.velocity_mps = Vec2::Zero();
    robot.as_of = status.received;
  }
  robot.is_known = true;
  robot.mode = status.mode;
  robot.arrived = status.arrived;
  robot.status_at = status.received;
  robot.ticks = status.ticks;
  robot.late_ticks = status.late_ticks;
}

void RosSwarm::on_event(const ObservedEvent& event) {
  if (event.severity == "info") return;
  last_warning_ = event.source + ": " + event.text;
  warned_at_ = event.received;
}

ros::Header RosSwarm::header(UtcTime now) const {
  return {.stamp = ros::time_of(now), .frame_id = frame_};
}

Vec2 RosSwarm::position_m(const Robot& robot, UtcTime now) {
  const Duration age = std::clamp(now - robot.as_of, Duration::zero(), kMostAge);
  return robot.position_m + to_seconds(age) * robot.velocity_mps;
}

ros::PoseArray RosSwarm::poses(UtcTime now) const {
  ros::PoseArray array{.header = header(now)};
  array.poses.reserve(robots_.size());
  for (const Robot& robot : robots_) {
    if (!robot.is_known) continue;
    const Vec2 at_m = position_m(robot, now);
    array.poses.push_back(
        {.position = {.x = at_m.x(), .y = at_m.y()}, .orientation = yaw(robot.heading_rad)});
  }
  return array;
}

ros::MarkerArray RosSwarm::markers(UtcTime now, Duration lifetime) const {
  const ros::Time span = ros::time_of(lifetime);
  const ros::Span vanishes{.sec = span.sec, .nanosec = span.nanosec};
  ros::Marker spheres{.header = header(now), .ns = "robots", .type = kSphereList};
  const double diameter_m = 2.0 * mission_->robots.radius_m;
  spheres.scale = {.x = diameter_m, .y = diameter_m, .z = diameter_m};
  spheres.color.a = 1.0F;
  spheres.lifetime = vanishes;
  for (const Robot& robot : robots_) {
    if (!robot.is_known) continue;
    const Vec2 at_m = position_m(robot, now);
    spheres.points.push_back({.x = at_m.x(), .y = at_m.y(), .z = diameter_m / 2});
    spheres.colors.push_back(color_of(robot.mode));
  }
  ros::MarkerArray array;
  array.markers.push_back(std::move(spheres));
  if (flow_.empty() || !clock_) return array;
  const Mixture planned = flow_.mixture_at(MissionTime(clock_->plan_time_s));
  for (const WeightedGaussian& part : planned.components()) {
    ros::Marker marker = ellipse(part);
    marker.header = header(now);
    marker.id = static_cast<std::int32_t>(array.markers.size());
    marker.lifetime = vanishes;
    array.markers.push_back(std::move(marker));
  }
  return array;
}

ros::DiagnosticStatus RosSwarm::mission_status(UtcTime now) const {
  const bool warns = !last_warning_.empty() && now - warned_at_ < kWarnedFor;
  const auto arrived = std::ranges::count(robots_, true, &Robot::arrived);
  const MissionPhase phase = clock_ ? clock_->phase : MissionPhase::kReady;
  ros::DiagnosticStatus status{.level = warns ? kWarning : kOk,
                               .name = "swarmflow: mission",
                               .message = warns ? last_warning_ : std::string(to_string(phase)),
                               .hardware_id = mission_->name};
  status.values = {
      value("phase", std::string(to_string(phase))),
      value("mission_time_s", fmt::format("{:.1f}", clock_ ? clock_->mission_time_s : 0.0)),
      value("plan_version", std::to_string(plan_version_)),
      value("robots", std::to_string(robots_.size())), value("arrived", std::to_string(arrived))};
  return status;
}

ros::DiagnosticStatus RosSwarm::robot_status(std::size_t i, UtcTime now) const {
  const Robot& robot = robots_[i];
  ros::DiagnosticStatus status{.name = fmt::format("swarmflow: robot {}", i),
                               .message = std::string(to_string(robot.mode)),
                               .hardware_id = fmt::format("robot-{}", i)};
  if (!robot.status_at) {
    status.level = kStaleLevel;
    status.message = "no status so far";
  } else if (now - *robot.status_at > kStale) {
    status.level = kStaleLevel;
    status.message = fmt::format("no status for {:.0f} s", to_seconds(now - *robot.status_at));
  } else if (robot.mode == RobotMode::kHolding || robot.mode == RobotMode::kStopped) {
    status.level = kWarning;
  }
  status.values = {value("ticks", std::to_string(robot.ticks)),
                   value("late_ticks", std::to_string(robot.late_ticks))};
  return status;
}

ros::DiagnosticArray RosSwarm::diagnostics(UtcTime now) const {
  ros::DiagnosticArray array{.header = header(now)};
  array.status.reserve(robots_.size() + 1);
  array.status.push_back(mission_status(now));
  for (std::size_t i = 0; i < robots_.size(); ++i) array.status.push_back(robot_status(i, now));
  return array;
}

double RosSwarm::cells(double resolution_m) const {
  const Box& bounds = mission_->world.bounds_m();
  const Vec2 size_m = bounds.max_m - bounds.min_m;
  return std::ceil(size_m.x() / resolution_m) * std::ceil(size_m.y() / resolution_m);
}

std::uint64_t RosSwarm::map_version(UtcTime now) {
  if (scene_.moves(now)) ++map_version_;
  return map_version_;
}

ros::OccupancyGrid RosSwarm::map(double resolution_m, UtcTime now) const {
  const World world = world_at(mission_->world, scene_, now);
  const Box& bounds = world.bounds_m();
  const Vec2 size_m = bounds.max_m - bounds.min_m;
  ros::OccupancyGrid grid{.header = header(now)};
  grid.info.map_load_time = grid.header.stamp;
  grid.info.resolution = static_cast<float>(resolution_m);
  grid.info.width = static_cast<std::uint32_t>(std::ceil(size_m.x() / resolution_m));
  grid.info.height = static_cast<std::uint32_t>(std::ceil(size_m.y() / resolution_m));
  grid.info.origin.position = {.x = bounds.min_m.x(), .y = bounds.min_m.y()};
  grid.data.reserve(std::size_t{grid.info.width} * grid.info.height);
  for (std::uint32_t row = 0; row < grid.info.height; ++row) {
    for (std::uint32_t column = 0; column < grid.info.width; ++column) {
      const Vec2 middle_m = bounds.min_m + resolution_m * Vec2(column + 0.5, row + 0.5);
      grid.data.push_back(world.is_clear(middle_m, 0.0) ? std::int8_t{0} : kOccupied);
    }
  }
  return grid;
}

}  // namespace swarm::monitor
