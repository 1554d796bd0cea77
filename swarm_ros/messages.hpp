// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "swarm_link/fields.hpp"

/// The messages of ROS 2 that are spoken here, field by field as in their packages (Humble to
/// Jazzy). On the wire they are plain CDR (XCDR1), as the codec of swarm_link writes it. Texts and
/// sequences have no bounds in ROS; ours are those of the samples that we write, and longer texts
/// of others are cut.
namespace swarm::ros {

using link::FieldList;
using link::up_to;

inline constexpr std::size_t kMaxText = 255;
inline constexpr std::size_t kMaxPoses = 20'000;
inline constexpr std::size_t kMaxCells = 64;

/// Six by six, row by row.
using Covariance = std::array<double, 36>;

/// A time since the epoch of its clock.
struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  bool operator==(const Time&) const = default;

  using M = Time;
  static constexpr std::string_view kRosType = "builtin_interfaces/msg/Time";
  static constexpr FieldList<&M::sec, &M::nanosec> kFields{};
};

/// A span of time.
struct Span {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  bool operator==(const Span&) const = default;

  using M = Span;
  static constexpr std::string_view kRosType = "builtin_interfaces/msg/Duration";
  static constexpr FieldList<&M::sec, &M::nanosec> kFields{};
};

/// When and in which frame.
struct Header {
  Time stamp{};
  std::string frame_id{};
  bool operator==(const Header&) const = default;

  using M = Header;
  static constexpr std::string_view kRosType = "std_msgs/msg/Header";
  static constexpr FieldList<&M::stamp, up_to(kMaxText, &M::frame_id)> kFields{};
};

/// A vector of three dimensions.
struct Vector3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  bool operator==(const Vector3&) const = default;

  using M = Vector3;
  static constexpr std::string_view kRosType = "geometry_msgs/msg/Vector3";
  static constexpr FieldList<&M::x, &M::y, &M::z> kFields{};
};

/// A position [m].
struct Point {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  bool operator==(const Point&) const = default;

  using M = Point;
  static constexpr std::string_view kRosType = "geometry_msgs/msg/Point";
  static constexpr FieldList<&M::x, &M::y, &M::z> kFields{};
};

/// An orientation.
struct Quaternion {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double w = 1.0;
  bool operator==(const Quaternion&) const = default;

  using M = Quaternion;
  static constexpr std::string_view kRosType = "geometry_msgs/msg/Quaternion";
  static constexpr FieldList<&M::x, &M::y, &M::z, &M::w> kFields{};
};

/// Position and orientation.
struct Pose {
  Point position{};
  Quaternion orientation{};
  bool operator==(const Pose&) const = default;

  using M = Pose;
  static constexpr std::string_view kRosType = "geometry_msgs/msg/Pose";
  static constexpr FieldList<&M::position, &M::orientation> kFields{};
};

/// A pose with time and frame.
struct PoseStamped {
  Header header{};
  Pose pose{};
  bool operator==(const PoseStamped&) const = default;

  using M = PoseStamped;
  static constexpr std::string_view kRosType = "geometry_msgs/msg/PoseStamped";
  static constexpr FieldList<&M::header, &M::pose> kFields{};
};

/// Poses of many.
struct PoseArray {
  Header header{};
  std::vector<Pose> poses{};
  bool operator==(const PoseArray&) const = default;

  using M = PoseArray;
  static constexpr std::string_view kRosType = "geometry_msgs/msg/PoseArray";
  static constexpr FieldList<&M::header, up_to(kMaxPoses, &M::poses)> kFields{};
};

/// A pose; covariance row by row of (x, y, z, roll, pitch, yaw).
struct PoseWithCovariance {
  Pose pose{};
  Covariance covariance{};
  bool operator==(const PoseWithCovariance&) const = default;

  using M = PoseWithCovariance;
  static constexpr std::string_view kRosType = "geometry_msgs/msg/PoseWithCovariance";
  static constexpr FieldList<&M::pose, &M::covariance> kFields{};
};

/// Velocities: linear [m/s], angular [rad/s].
struct Twist {
  Vector3 linear{};
  Vector3 angular{};
  bool operator==(const Twist&) const = default;

  using M = Twist;
  static constexpr std::string_view kRosType = "geometry_msgs/msg/Twist";
  static constexpr FieldList<&M::linear, &M::angular> kFields{};
};

/// A twist with time and frame.
struct TwistStamped {
  Header header{};
  Twist twist{};
  bool operator==(const TwistStamped&) const = default;

  using M = TwistStamped;
  static constexpr std::string_view kRosType = "geometry_msgs/msg/TwistStamped";
  static constexpr FieldList<&M::header, &M::twist> kFields{};
};

/// A twist with the covariance of its six components.
struct TwistWithCovariance {
  Twist twist{};
  Covariance covariance{};
  bool operator==(const TwistWithCovariance&) const = default;

  using M = TwistWithCovariance;
  static constexpr std::string_view kRosType = "geometry_msgs/msg/TwistWithCovariance";
  static constexpr FieldList<&M::twist, &M::covariance> kFields{};
};

/// Pose in header.frame_id, twist in child_frame_id.
struct Odometry {
  Header header{};
  std::string child_frame_id{};
  PoseWithCovariance pose{};
  TwistWithCovariance twist{};
  bool operator==(const Odometry&) const = default;

  using M = Odometry;
  static constexpr std::string_view kRosType = "nav_msgs/msg/Odometry";
  static constexpr FieldList<&M::header, up_to(kMaxText, &M::child_frame_id), &M::pose, &M::twist>
      kFields{};
};

/// A battery; NaN where a value is not measured.
struct BatteryState {
  Header header{};
  float voltage = 0.0F;
  float temperature = 0.0F;
  float current = 0.0F;
  float charge = 0.0F;
  float capacity = 0.0F;
  float design_capacity = 0.0F;
  float percentage = 0.0F;
  std::uint8_t power_supply_status = 0;
  std::uint8_t power_supply_health = 0;
  std::uint8_t power_supply_technology = 0;
  bool present = false;
  std::vector<float> cell_voltage{};
  std::vector<float> cell_temperature{};
  std::string location{};
  std::string serial_number{};
  bool operator==(const BatteryState&) const = default;

  using M = BatteryState;
  static constexpr std::string_view kRosType = "sensor_msgs/msg/BatteryState";
  static constexpr FieldList<
      &M::header, &M::voltage, &M::temperature, &M::current, &M::charge, &M::capacity,
      &M::design_capacity, &M::percentage, &M::power_supply_status, &M::power_supply_health,
      &M::power_supply_technology, &M::present, up_to(kMaxCells, &M::cell_voltage),
      up_to(kMaxCells, &M::cell_temperature), up_to(kMaxText, &M::location),
      up_to(kMaxText, &M::serial_number)>
      kFields{};
};

/// Yes or no.
struct Bool {
  bool data = false;
  bool operator==(const Bool&) const = default;

  using M = Bool;
  static constexpr std::string_view kRosType = "std_msgs/msg/Bool";
  static constexpr FieldList<&M::data> kFields{};
};

/// Crazyswarm2: velocity in the world frame [m/s], yaw rate.
struct VelocityWorld {
  Header header{};
  Vector3 vel{};
  float yaw_rate = 0.0F;
  bool operator==(const VelocityWorld&) const = default;

  using M = VelocityWorld;
  static constexpr std::string_view kRosType = "crazyflie_interfaces/msg/VelocityWorld";
  static constexpr FieldList<&M::header, &M::vel, &M::yaw_rate> kFields{};
};

}  // namespace swarm::ros
