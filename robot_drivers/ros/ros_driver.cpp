// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_drivers/ros/ros_driver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "robot_drivers/ros/ros_robot.hpp"
#include "robot_drivers/ros/ros_session.hpp"
#include "robot_drivers/ros/stamp_clock.hpp"
#include "swarm_ros/ros_names.hpp"

namespace swarm::drivers {
namespace {

constexpr Duration kFirstPose = std::chrono::seconds(10);
constexpr Duration kPoll = std::chrono::milliseconds(20);
// A refused pose counts as a fault for this time.
constexpr Duration kRefusedFor = std::chrono::seconds(2);
// A robot above this height flies.
constexpr double kFlies_m = 0.1;
constexpr const char* kByOwnTools = "take it off and land it by the tools of its own";

/// One robot of a ROS domain.
class RosDriver final : public agent::Driver {
 public:
  RosDriver(RosOptions options, const RosPreset& preset, RobotId robot, const BodySpec& body)
      : options_(std::move(options)),
        preset_(preset),
        frames_(options_),
        robot_(robot),
        turn_rate_max_radps_(body.turn_rate_max_radps) {}

  // Waits for the first pose: a plan needs to know where the robot is.
  Result<void> start() override {
    auto session = ros_session();
    if (!session) return tl::unexpected(session.error());
    session_ = *std::move(session);
    received_at_ = measured_at_ = std::chrono::steady_clock::now();
    if (auto made = make_endpoints(); !made) return made;
    const SteadyTime until = measured_at_ + kFirstPose;
    while (!pose_ && measured_at_ < until) {
      std::this_thread::sleep_for(kPoll);
      measure(std::chrono::steady_clock::now());
    }
    if (pose_) return {};
    return fail(ErrorCode::kEnvironment,
                fmt::format("robot {}: no pose on /{} within {:g} s in the ROS domain of the "
                            "environment; does the robot run, and in this domain?",
                            robot_.value(), pose_topic(), to_seconds(kFirstPose)));
  }

  agent::BodyAbilities abilities() const override {
    const bool turns =
        preset_.command == RosCommand::kTwist || preset_.command == RosCommand::kTwistStamped;
    return {.flies = preset_.flies,
            .reverses = !turns,
            .stops_within = from_seconds(options_.stops_within_s)};
  }

  agent::Measurement measure(SteadyTime now) override {
    measured_at_ = now;
    session_->receive();
    take(odometry_, now);
    take(poses_, now);
    take_battery();
    agent::Measurement m;
    if (!pose_) {
      m.is_valid = false;
      return m;
    }
    m.position_m = pose_->position_m;
    m.age = now - received_at_ + age_;
    m.covariance_m2 = pose_->covariance_m2;
    m.velocity_mps = pose_->velocity_mps;
    m.heading_rad = pose_->heading_rad;
    m.height_m = pose_->height_m;
    return m;
  }

  /// A base without a heading is not driven. The robot's own watchdog stops it when commands end.
  void command(SteadyTime /*now*/, const Vec2& velocity_mps, Duration /*valid_for*/) override {
    switch (preset_.command) {
      case RosCommand::kTwist:
        if (pose_) twist_->write(drive(velocity_mps));
        return;
      case RosCommand::kBodyTwist:
        if (pose_) twist_->write(frames_.slide(velocity_mps, pose_->heading_rad));
        return;
      case RosCommand::kTwistStamped:
        if (pose_) stamped_->write({.header = header("base_link"), .twist = drive(velocity_mps)});
        return;
      case RosCommand::kWorldTwist: {
        const Vec2 v = frames_.to_robot_world(velocity_mps);
        stamped_->write({.header = header(options_.frame),
                         .twist = {.linear = {.x = v.x(), .y = v.y(), .z = 0.0}, .angular = {}}});
        return;
      }
      case RosCommand::kVelocityWorld: {
        const Vec2 v = frames_.to_robot_world(velocity_mps);
        world_->write({.header = header("world"), .vel = {.x = v.x(), .y = v.y(), .z = climb()}});
        return;
      }
    }
  }

  /// Whatever the kind: these topics have no other stop.
  void stop(SteadyTime now, agent::StopKind /*kind*/) override {
    command(now, Vec2::Zero(), std::chrono::seconds(1));
  }

  Result<void> begin(agent::Manoeuvre what) override {
    if (!preset_.flies || (is_flying() && what != agent::Manoeuvre::kDisarm)) return {};
    return fail(ErrorCode::kBadInput, kByOwnTools);
  }

  agent::DriverHealth health() const override {
    agent::DriverHealth health;
    if (refused_at_ && measured_at_ - *refused_at_ < kRefusedFor) {
      health.level = agent::DriverHealth::Level::kDegraded;
      health.text = fmt::format("poses on /{} are refused: not finite, or without an orientation",
                                pose_topic());
    }
    health.battery = battery_;
    health.battery_v = battery_v_;
    if (preset_.flies) health.is_flying = is_flying();
    health.silence = measured_at_ - received_at_;
    return health;
  }

  void shutdown() override {
    twist_.reset();
    stamped_.reset();
    world_.reset();
    poses_.reset();
    odometry_.reset();
    batteries_.reset();
    session_.reset();
  }

 private:
  std::string topic(const std::string& chosen, const std::string& usual) const {
    return ros_topic(options_.name_space, chosen, usual, robot_);
  }
  std::string pose_topic() const { return topic(options_.pose_topic, preset_.pose_topic); }
  bool is_flying() const { return pose_ && pose_->height_m > kFlies_m; }

  template <class M>
  Result<void> make(link::WriterPtr<M>& writer, const std::string& topic) {
    auto made = ros::make_writer<M>(*session_, topic, ros::kCommandQos);
    if (!made) return tl::unexpected(made.error());
    writer = *std::move(made);
    return {};
  }
  template <class M>
  Result<void> make(link::ReaderPtr<M>& reader, const std::string& topic) {
    auto made = ros::make_reader<M>(*session_, topic);
    if (!made) return tl::unexpected(made.error());
    reader = *std::move(made);
    return {};
  }

  Result<void> make_endpoints() {
    const std::string commands = topic(options_.command_topic, preset_.command_topic);
    Result<void> made;
    switch (preset_.command) {
      case RosCommand::kTwist:
      case RosCommand::kBodyTwist:
        made = make(twist_, commands);
        break;
      case RosCommand::kTwistStamped:
      case RosCommand::kWorldTwist:
        made = make(stamped_, commands);
        break;
      case RosCommand::kVelocityWorld:
        made = make(world_, commands);
        break;
    }
    if (made)
      made = preset_.has_odometry ? make(odometry_, pose_topic()) : make(poses_, pose_topic());
    if (made) made = make(batteries_, topic(options_.battery_topic, "battery_state"));
    return made;
  }

  /// The newest pose that counts, see StampClock.
  template <class M>
  void take(link::ReaderPtr<M>& reader, SteadyTime now) {
    if (reader == nullptr) return;
    std::vector<M> messages;
    reader->take(messages);
    for (const M& message : messages) {
      const auto pose = frames_.pose(message);
      if (!pose) {
        refused_at_ = now;
        continue;
      }
      const auto age = stamps_.age_of(pose->stamp, now);
      if (!age) continue;
      pose_ = pose;
      received_at_ = now;
      age_ = *age;
    }
  }

  void take_battery() {
    std::vector<ros::BatteryState> messages;
    batteries_->take(messages);
    if (messages.empty()) return;
    const ros::BatteryState& last = messages.back();
    battery_ = std::isfinite(last.percentage)
                   ? std::optional(std::clamp<double>(last.percentage, 0.0, 1.0))
                   : std::nullopt;
    battery_v_ = std::isfinite(last.voltage) ? std::optional<double>(last.voltage) : std::nullopt;
  }

  ros::Twist drive(const Vec2& velocity_mps) const {
    return frames_.drive(velocity_mps, pose_->heading_rad, turn_rate_max_radps_);
  }
  /// By the clock of the robot, as its last pose shows it: a robot drops commands whose stamp is
  /// old by its own clock.
  ros::Header header(const std::string& frame) const {
    ros::Header header{.stamp = {}, .frame_id = frame};
    if (!pose_ || pose_->stamp == ros::Time{}) return header;
    const Duration since = measured_at_ - received_at_ + age_;
    header.stamp = ros::time_of(ros::duration_of(pose_->stamp) + since);
    return header;
  }
  /// Vertical speed that keeps the height.
  double climb() const {
    constexpr double kGain_hz = 1.0, kMost_mps = 0.5;
    if (!pose_ || options_.height_m <= 0.0) return 0.0;
    return std::clamp(kGain_hz * (options_.height_m - pose_->height_m), -kMost_mps, kMost_mps);
  }

  RosOptions options_;
  const RosPreset& preset_;
  RosFrames frames_;
  RobotId robot_;
  double turn_rate_max_radps_;
  std::shared_ptr<link::Participant> session_;
  link::WriterPtr<ros::Twist> twist_;
  link::WriterPtr<ros::TwistStamped> stamped_;
  link::WriterPtr<ros::VelocityWorld> world_;
  link::ReaderPtr<ros::PoseStamped> poses_;
  link::ReaderPtr<ros::Odometry> odometry_;
  link::ReaderPtr<ros::BatteryState> batteries_;
  std::optional<RosPose> pose_;
  SteadyTime received_at_;  // of the newest pose
  Duration age_{};          // that it had then
  StampClock stamps_;
  SteadyTime measured_at_;
  std::optional<SteadyTime> refused_at_;  // a pose, last
  std::optional<double> battery_;
  std::optional<double> battery_v_;
};

}  // namespace

void register_ros_driver(agent::DriverRegistry& registry) {
  registry.add(
      {.spec = ros_driver_spec(),
       .make = [](const agent::DriverContext& context) -> Result<std::unique_ptr<agent::Driver>> {
         const RosOptions options = ros_option_table().read(context.options());
         const RosPreset* const preset = find_ros_preset(options.preset);
         if (preset == nullptr) {
           return fail(ErrorCode::kBadInput,
                       fmt::format("robots.ros_preset is {}", options.preset));
         }
         return std::make_unique<RosDriver>(options, *preset, context.robot, context.body());
       }});
}

}  // namespace swarm::drivers
