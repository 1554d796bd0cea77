// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/core/world.hpp"

// What script and operator change while a mission runs.
namespace swarm {

/// Scene change: adds an obstacle at rest. It gets the next obstacle number (Scene::next_id).
struct AddObstacle {
  Obstacle shape;  ///< where it is, world frame
};
/// Scene change: moves an obstacle, at once or evenly over a time. A move replaces one under way
/// and begins at the obstacle's present position.
struct MoveObstacle {
  std::uint32_t obstacle = 0;  ///< its number
  Vec2 by_m = Vec2::Zero();    ///< displacement [m]
  double over_s = 0.0;         ///< duration of the move; 0: at once [s]
};
/// Scene change: removes an obstacle, of the mission file or added.
struct RemoveObstacle {
  std::uint32_t obstacle = 0;  ///< its number, which is not used again
};
/// Scene change: a new goal mixture for the whole swarm.
struct GoTo {
  Mixture goal;  ///< replaces the goal in force
};
/// Scene change: a new risk level.
struct SetRisk {
  double alpha = 0.05;  ///< α of RiskLimit, in (0, 1)
};
/// Scene change by the launcher: a robot is dead or silent, so its body stays where it is and
/// becomes an obstacle. A robot has one body: a second one replaces the first.
struct AddBody {
  RobotId robot;  ///< the robot
  Circle shape;   ///< covers every position its body may have
};
/// Scene change: the body of a robot is no obstacle any more, because the robot is received again
/// or was carried away.
struct ClearBody {
  RobotId robot;  ///< the robot whose body it was
};
/// Any change of the scene. Obstacles are identified by number: those of the mission file by their
/// index in it, added ones by the next number; a number is never used twice.
using SceneChange =
    std::variant<AddObstacle, MoveObstacle, RemoveObstacle, GoTo, SetRisk, AddBody, ClearBody>;

/// The name of a change in scripts and on the command line: add_obstacle, move_obstacle,
/// remove_obstacle, goto, risk, add_body (by the launcher alone), clear.
std::string_view name_of(const SceneChange& change);

/// An obstacle that differs from the mission file: moved, or added.
struct SceneObstacle {
  std::uint32_t id = 0;              ///< its number
  std::optional<RobotId> owner{};    ///< the robot whose body it is; empty: an ordinary obstacle
  Obstacle shape;                    ///< where it is until `moving_from`
  Vec2 velocity_mps = Vec2::Zero();  ///< its velocity while it moves [m/s]
  UtcTime moving_from{};             ///< begin of its last move
  UtcTime moving_until{};            ///< end of its last move; not after the begin: it is at rest

  /// Whether it moves at a time.
  bool moves(UtcTime now) const { return moving_from <= now && now < moving_until; }
  /// Its displacement from `shape` at a time, before, in or after the move [m].
  Vec2 shift_m(UtcTime now) const;
  /// Its shape at a time. O(vertices), allocates.
  Obstacle at(UtcTime now) const;
};

/// Everything that changed since the mission file, as a state and not as a list of events: one
/// message brings a late or restarted process up to date. Owned by the launcher, published on topic
/// swarm/scene.
struct Scene {
  static constexpr std::size_t kMaxObstacles = 256;  ///< most moved or added obstacles, with bodies
  static constexpr std::size_t kMaxRemoved = 256;    ///< most removed obstacles
  static constexpr std::size_t kMaxVertices = 4096;  ///< most vertices of all its polygons together
  static constexpr double kMaxCoordinate_m = 1e6;    ///< largest coordinate of an obstacle [m]
  static constexpr double kMaxSpeed_mps = 1e6;       ///< largest speed of an obstacle [m/s]

  std::uint64_t version = 0;  ///< UTC time of the last change [ns]; 0: as in the mission file
  std::vector<std::uint32_t> removed;    ///< numbers of removed obstacles of the mission file
  std::vector<SceneObstacle> obstacles;  ///< moved and added ones, bodies last; by ascending id
  std::uint32_t next_id = 0;             ///< number of the next obstacle to be added
  std::optional<Mixture> goal;           ///< goal in force; empty: that of the mission file
  std::optional<double> risk_alpha;  ///< risk level α in force; empty: that of the mission file

  /// Whether any obstacle moves at a time. O(obstacles).
  bool moves(UtcTime now) const;
};

/// Number of robot 0's body as an obstacle. Bodies have numbers above those of all other obstacles,
/// so the number of an obstacle that a script adds does not depend on how many robots died before.
inline constexpr std::uint32_t kFirstBodyId = 0x8000'0000;
/// Number of a robot's body as an obstacle.
constexpr std::uint32_t body_id(RobotId robot) { return kFirstBodyId + robot.value(); }

/// The scene of a mission before any change: version 0.
/// \param mission_obstacles number of obstacles in the mission file
Scene first_scene(std::size_t mission_obstacles);

/// The scene after a change. Its version is the larger of `now` and the old version + 1.
/// \param scene the scene before the change
/// \param change what is to change; shapes and goals were checked when they were read
/// \param mission_world the world of the mission file
/// \param now time of the change
/// \return kBadInput for an obstacle or body that does not exist, and for a scene over its bounds
Result<Scene> after(const Scene& scene, const SceneChange& change, const World& mission_world,
                    UtcTime now);

/// The map at a time: the obstacles of the mission file without the removed ones, moved ones at
/// their index, then added ones, then bodies. Moving obstacles have their velocity. O(n log n) in
/// the obstacles and O(vertices), allocates.
World world_at(const World& mission_world, const Scene& scene, UtcTime now);

/// A map for planning over a period: as world_at() at its begin, and obstacles that move during the
/// period also at its middle and end. Without velocities and without marked bodies.
World world_during(const World& mission_world, const Scene& scene, UtcTime begin, Duration span);

/// A period of a run in which every obstacle is at rest or moves at constant velocity.
struct WorldPhase {
  UtcTime begin{};  ///< when it begins; it ends with the begin of the next one
  World world;      ///< map at `begin`, with velocities
};

/// The maps of a run that went through these scenes, by ascending time; the first one begins at the
/// epoch if the first scene has version 0. Without bodies of dead robots.
std::vector<WorldPhase> world_phases(const World& mission_world, const std::vector<Scene>& scenes);

/// The map of the obstacles of the mission file that were neither moved nor removed in any of these
/// scenes: a path that was free during the run is free in it. Without bodies of dead robots.
World lasting_world(const World& mission_world, const std::vector<Scene>& scenes);

}  // namespace swarm
