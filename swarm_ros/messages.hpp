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
inline constexpr std::size_t kMaxGrid = 16U << 20U;
inline constexpr std::size_t kMaxValues = 64;
inline constexpr std::size_t kMaxStatuses = 20'000;
inline constexpr std::size_t kMaxPoints = 100'000;
inline constexpr std::size_t kMaxMarkers = 10'000;
inline constexpr std::size_t kMaxFile = 1U << 20U;

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

/// Size and place of a grid.
struct MapMetaData {
  Time map_load_time{};
  float resolution = 0.0F;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  Pose origin{};
  bool operator==(const MapMetaData&) const = default;

  using M = MapMetaData;
  static constexpr std::string_view kRosType = "nav_msgs/msg/MapMetaData";
  static constexpr FieldList<&M::map_load_time, &M::resolution, &M::width, &M::height, &M::origin>
      kFields{};
};

/// Row by row: -1 unknown, 0 free to 100 occupied.
struct OccupancyGrid {
  Header header{};
  MapMetaData info{};
  std::vector<std::int8_t> data{};
  bool operator==(const OccupancyGrid&) const = default;

  using M = OccupancyGrid;
  static constexpr std::string_view kRosType = "nav_msgs/msg/OccupancyGrid";
  static constexpr FieldList<&M::header, &M::info, up_to(kMaxGrid, &M::data)> kFields{};
};

/// One value of a status.
struct KeyValue {
  std::string key{};
  std::string value{};
  bool operator==(const KeyValue&) const = default;

  using M = KeyValue;
  static constexpr std::string_view kRosType = "diagnostic_msgs/msg/KeyValue";
  static constexpr FieldList<up_to(kMaxText, &M::key), up_to(kMaxText, &M::value)> kFields{};
};

/// Level 0 good, 1 warning, 2 error, 3 stale.
struct DiagnosticStatus {
  std::uint8_t level = 0;
  std::string name{};
  std::string message{};
  std::string hardware_id{};
  std::vector<KeyValue> values{};
  bool operator==(const DiagnosticStatus&) const = default;

  using M = DiagnosticStatus;
  static constexpr std::string_view kRosType = "diagnostic_msgs/msg/DiagnosticStatus";
  static constexpr FieldList<&M::level, up_to(kMaxText, &M::name), up_to(kMaxText, &M::message),
                             up_to(kMaxText, &M::hardware_id), up_to(kMaxValues, &M::values)>
      kFields{};
};

/// The states of many components.
struct DiagnosticArray {
  Header header{};
  std::vector<DiagnosticStatus> status{};
  bool operator==(const DiagnosticArray&) const = default;

  using M = DiagnosticArray;
  static constexpr std::string_view kRosType = "diagnostic_msgs/msg/DiagnosticArray";
  static constexpr FieldList<&M::header, up_to(kMaxStatuses, &M::status)> kFields{};
};

/// Each from 0 to 1.
struct ColorRgba {
  float r = 0.0F;
  float g = 0.0F;
  float b = 0.0F;
  float a = 0.0F;
  bool operator==(const ColorRgba&) const = default;

  using M = ColorRgba;
  static constexpr std::string_view kRosType = "std_msgs/msg/ColorRGBA";
  static constexpr FieldList<&M::r, &M::g, &M::b, &M::a> kFields{};
};

/// An image as a file has it.
struct CompressedImage {
  Header header{};
  std::string format{};
  std::vector<std::uint8_t> data{};
  bool operator==(const CompressedImage&) const = default;

  using M = CompressedImage;
  static constexpr std::string_view kRosType = "sensor_msgs/msg/CompressedImage";
  static constexpr FieldList<&M::header, up_to(kMaxText, &M::format), up_to(kMaxFile, &M::data)>
      kFields{};
};

/// A position in a texture.
struct UvCoordinate {
  float u = 0.0F;
  float v = 0.0F;
  bool operator==(const UvCoordinate&) const = default;

  using M = UvCoordinate;
  static constexpr std::string_view kRosType = "visualization_msgs/msg/UVCoordinate";
  static constexpr FieldList<&M::u, &M::v> kFields{};
};

/// A mesh as a file has it.
struct MeshFile {
  std::string filename{};
  std::vector<std::uint8_t> data{};
  bool operator==(const MeshFile&) const = default;

  using M = MeshFile;
  static constexpr std::string_view kRosType = "visualization_msgs/msg/MeshFile";
  static constexpr FieldList<up_to(kMaxText, &M::filename), up_to(kMaxFile, &M::data)> kFields{};
};

/// A shape that RViz draws; since Humble.
struct Marker {
  Header header{};
  std::string ns{};
  std::int32_t id = 0;
  std::int32_t type = 0;
  std::int32_t action = 0;
  Pose pose{};
  Vector3 scale{};
  ColorRgba color{};
  Span lifetime{};
  bool frame_locked = false;
  std::vector<Point> points{};
  std::vector<ColorRgba> colors{};
  std::string texture_resource{};
  CompressedImage texture{};
  std::vector<UvCoordinate> uv_coordinates{};
  std::string text{};
  std::string mesh_resource{};
  MeshFile mesh_file{};
  bool mesh_use_embedded_materials = false;
  bool operator==(const Marker&) const = default;

  using M = Marker;
  static constexpr std::string_view kRosType = "visualization_msgs/msg/Marker";
  static constexpr FieldList<
      &M::header, up_to(kMaxText, &M::ns), &M::id, &M::type, &M::action, &M::pose, &M::scale,
      &M::color, &M::lifetime, &M::frame_locked, up_to(kMaxPoints, &M::points),
      up_to(kMaxPoints, &M::colors), up_to(kMaxText, &M::texture_resource), &M::texture,
      up_to(kMaxPoints, &M::uv_coordinates), up_to(kMaxText, &M::text),
      up_to(kMaxText, &M::mesh_resource), &M::mesh_file, &M::mesh_use_embedded_materials>
      kFields{};
};

/// Many markers.
struct MarkerArray {
  std::vector<Marker> markers{};
  bool operator==(const MarkerArray&) const = default;

  using M = MarkerArray;
  static constexpr std::string_view kRosType = "visualization_msgs/msg/MarkerArray";
  static constexpr FieldList<up_to(kMaxMarkers, &M::markers)> kFields{};
};

}  // namespace swarm::ros
