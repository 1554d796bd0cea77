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
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/world.hpp"

/// What script and user change while a mission runs. Obstacles are known by number: those of the
/// mission file by their place in it, an added one by the next number, never used twice.
namespace swarm {

struct AddObstacle {
  Obstacle shape;
};
/// Shifts an obstacle, at once or evenly over a time; a new move begins where the last one is.
struct MoveObstacle {
  std::uint32_t obstacle = 0;
  Vec2 by_m = Vec2::Zero();
  double over_s = 0.0;
};
struct RemoveObstacle {
  std::uint32_t obstacle = 0;
};
/// New goal mixture for the whole swarm.
struct GoTo {
  Mixture goal;
};
/// New risk level α.
struct SetRisk {
  double alpha = 0.05;
};
/// A robot is not received any more: its body stays where it is and becomes an obstacle. A robot
/// has one body: a second one replaces the first.
struct AddBody {
  RobotId robot;
  Circle shape;
};
/// The body of a robot is no obstacle any more: the robot is received again, or was carried away.
struct ClearBody {
  RobotId robot;
};
using SceneChange =
    std::variant<AddObstacle, MoveObstacle, RemoveObstacle, GoTo, SetRisk, AddBody, ClearBody>;

/// The words of script and command line: add_obstacle, move_obstacle, remove_obstacle, goto, risk,
/// add_body (of the launcher alone), clear.
std::string_view name_of(const SceneChange& change);

/// An obstacle that differs from the mission file: moved, or added.
struct SceneObstacle {
  std::uint32_t id = 0;
  std::optional<RobotId> owner{};  ///< the robot whose body it is
  Obstacle shape;                  ///< where it stands until `moving_from`
  Vec2 velocity_mps = Vec2::Zero();
  UtcTime moving_from{};
  UtcTime moving_until{};

  bool moves(UtcTime now) const { return moving_from <= now && now < moving_until; }
  /// How far it is from `shape` by now.
  Vec2 shift_m(UtcTime now) const;
  Obstacle at(UtcTime now) const;
};

/// All that changed since the mission file, as a state and not as events: whoever hears the newest
/// one knows everything, whatever it missed. The launcher owns it; topic swarm/scene carries it.
struct Scene {
  static constexpr std::size_t kMaxObstacles = 256;
  static constexpr std::size_t kMaxRemoved = 256;
  static constexpr std::size_t kMaxVertices = 4096;  ///< of all its polygons together

  std::uint64_t version = 0;  ///< UTC nanoseconds of the last change; 0 = as in the mission file
  std::vector<std::uint32_t> removed;    ///< obstacles of the mission file that are gone
  std::vector<SceneObstacle> obstacles;  ///< by ascending id
  std::uint32_t next_id = 0;             ///< of the next obstacle to be added
  std::optional<Mixture> goal;
  std::optional<double> risk_alpha;

  /// Whether an obstacle is on its way.
  bool moves(UtcTime now) const;
};

/// Bodies have numbers of their own, behind those of all other obstacles: how many robots fall does
/// not change the number of an obstacle that a script adds later.
inline constexpr std::uint32_t kFirstBodyId = 0x8000'0000;
constexpr std::uint32_t body_id(RobotId robot) { return kFirstBodyId + robot.value(); }

/// The scene of a mission that starts with so many obstacles.
Scene first_scene(std::size_t mission_obstacles);

/// The scene after a change that is made now. Refuses obstacles that do not exist and more than the
/// bounds; then the scene stays as it is. \pre `mission_world` is the one of the mission file
Result<Scene> after(const Scene& scene, const SceneChange& change, const World& mission_world,
                    UtcTime now);

/// The map as it stands at a time: the mission file's obstacles without the removed ones, moved
/// ones in their place, added ones last. O(vertices).
World world_at(const World& mission_world, const Scene& scene, UtcTime now);

/// The same for a while: obstacles that move then are where they are at its begin, middle and end.
World world_during(const World& mission_world, const Scene& scene, UtcTime begin, Duration span);

/// The map for as long as every obstacle stands or moves evenly.
struct WorldPhase {
  UtcTime begin{};  ///< until that of the next one
  World world;      ///< at `begin`
};

/// All maps of a run that went through these scenes, the first from the beginning of time on.
/// Without bodies: those are robots, see bodies_of() in scene_bodies.hpp.
std::vector<WorldPhase> world_phases(const World& mission_world, const std::vector<Scene>& scenes);

/// The obstacles of the mission file that stood where they stand all the time: whoever gets around
/// the others gets around these. Without bodies.
World lasting_world(const World& mission_world, const std::vector<Scene>& scenes);

}  // namespace swarm
