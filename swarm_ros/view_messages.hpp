// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "swarm_ros/messages.hpp"

/// Messages of ROS 2 by which tools show a swarm: maps, markers, diagnostics.
namespace swarm::ros {

inline constexpr std::size_t kMaxGrid = 16U << 20U;
inline constexpr std::size_t kMaxValues = 64;
inline constexpr std::size_t kMaxStatuses = 20'000;
inline constexpr std::size_t kMaxPoints = 100'000;
inline constexpr std::size_t kMaxMarkers = 10'000;
inline constexpr std::size_t kMaxFile = 1U << 20U;

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
