// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "swarm_link/fields.hpp"
#include "swarm_link/schema_version.hpp"

/// The changes of the scene on the wire; see messages.hpp.
namespace swarm::link {

/// Bounds of the sequences of a scene, as in the IDL.
inline constexpr std::size_t kMaxSceneObstacles = 256;
inline constexpr std::size_t kMaxSceneRemoved = 256;
inline constexpr std::size_t kMaxSceneVertices = 4096;
inline constexpr std::size_t kMaxSceneGoals = 255;

/// SceneObstacleMessage::owner_robot_id of an obstacle that is not a robot's body.
inline constexpr std::uint32_t kNoRobot = 0xFFFF'FFFF;

/// A point of the world frame, ENU.
struct PointMessage {
  double x_m = 0, y_m = 0;
  bool operator==(const PointMessage&) const = default;

  using M = PointMessage;
  static constexpr std::string_view kIdlName = "Point";
  static constexpr FieldList<&M::x_m, &M::y_m> kFields{};
};

/// An obstacle that was added or moved: a polygon of the next `vertices` of SceneMessage::vertices,
/// or a circle. It moves at its velocity between two times and rests before and after.
struct SceneObstacleMessage {
  std::uint32_t obstacle_id = 0;  ///< ascending within a message
  std::uint32_t owner_robot_id = kNoRobot;
  std::uint32_t vertices = 0;                     ///< 0: a circle
  PointMessage center{};                          ///< of a circle
  double radius_m = 0;                            ///< of a circle
  double velocity_x_mps = 0, velocity_y_mps = 0;  ///< zero for a robot's body
  std::int64_t moving_from_utc_ns = 0, moving_until_utc_ns = 0;
  bool operator==(const SceneObstacleMessage&) const = default;

  using M = SceneObstacleMessage;
  static constexpr std::string_view kIdlName = "SceneObstacle";
  static constexpr FieldList<&M::obstacle_id, &M::owner_robot_id, &M::vertices, &M::center,
                             &M::radius_m, &M::velocity_x_mps, &M::velocity_y_mps,
                             &M::moving_from_utc_ns, &M::moving_until_utc_ns>
      kFields{};
};

/// One Gaussian of the goal mixture.
struct GoalComponentMessage {
  double mean_x_m = 0, mean_y_m = 0;  ///< world frame, ENU
  double covariance_xx_m2 = 0, covariance_xy_m2 = 0, covariance_yy_m2 = 0;
  double weight = 0;  ///< share of the robots
  bool operator==(const GoalComponentMessage&) const = default;

  using M = GoalComponentMessage;
  static constexpr std::string_view kIdlName = "GoalComponent";
  static constexpr FieldList<&M::mean_x_m, &M::mean_y_m, &M::covariance_xx_m2, &M::covariance_xy_m2,
                             &M::covariance_yy_m2, &M::weight>
      kFields{};
};

/// All changes since the mission file: a complete state, so one message is enough for a late
/// reader.
struct SceneMessage {
  std::uint16_t schema_version = kSchemaVersion;
  std::uint64_t version = 0;                      ///< increases with every change
  double risk_alpha = 0;                          ///< 0: as in the mission file
  std::uint32_t next_id = 0;                      ///< id of the next obstacle to be added
  std::vector<std::uint32_t> removed{};           ///< ids of the mission file's obstacles
  std::vector<SceneObstacleMessage> obstacles{};  ///< added or moved, sorted by id
  std::vector<PointMessage> vertices{};           ///< of all polygons, in their order
  std::vector<GoalComponentMessage> goal{};       ///< empty: as in the mission file
  bool operator==(const SceneMessage&) const = default;

  using M = SceneMessage;
  static constexpr std::string_view kIdlName = "Scene";
  static constexpr FieldList<
      &M::schema_version, &M::version, &M::risk_alpha, &M::next_id,
      up_to(kMaxSceneRemoved, &M::removed), up_to(kMaxSceneObstacles, &M::obstacles),
      up_to(kMaxSceneVertices, &M::vertices), up_to(kMaxSceneGoals, &M::goal)>
      kFields{};
};

}  // namespace swarm::link
