// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/mission/scene.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/mission/scene_bodies.hpp"

namespace swarm {
namespace {

Obstacle shifted(const Obstacle& obstacle, const Vec2& by_m) {
  if (const auto* circle = std::get_if<Circle>(&obstacle)) {
    return Circle{.center_m = circle->center_m + by_m, .radius_m = circle->radius_m};
  }
  return std::get<Polygon>(obstacle).shifted(by_m);
}

/// Whether receivers accept an obstacle at this place (scene_check.cpp). False for NaN.
bool is_within_limits(const Obstacle& obstacle) {
  const auto is_place = [](const Vec2& p) {
    return p.cwiseAbs().maxCoeff() <= Scene::kMaxCoordinate_m;
  };
  if (const auto* circle = std::get_if<Circle>(&obstacle)) return is_place(circle->center_m);
  return std::ranges::all_of(std::get<Polygon>(obstacle).vertices_m(), is_place);
}

std::size_t vertices_of(const Obstacle& obstacle) {
  const auto* polygon = std::get_if<Polygon>(&obstacle);
  return polygon == nullptr ? 0 : polygon->vertices_m().size();
}

/// Obstacles are sorted by id: the first one that is not below `id`.
auto find_obstacle(std::vector<SceneObstacle>& obstacles, std::uint32_t id) {
  return std::lower_bound(
      obstacles.begin(), obstacles.end(), id,
      [](const SceneObstacle& o, std::uint32_t wanted) { return o.id < wanted; });
}

/// The obstacle as a scene obstacle, taken over from the mission file where it is still there.
Result<SceneObstacle*> find(Scene& scene, std::uint32_t id, const World& mission_world) {
  const auto at = find_obstacle(scene.obstacles, id);
  if (at != scene.obstacles.end() && at->id == id) return &*at;
  const bool removed =
      std::find(scene.removed.begin(), scene.removed.end(), id) != scene.removed.end();
  if (id >= mission_world.obstacles().size() || removed) {
    return fail(ErrorCode::kBadInput,
                fmt::format("there is no obstacle {}; the mission file has 0 to {}, added ones "
                            "follow in order, removed ones stay away",
                            id, static_cast<std::int64_t>(mission_world.obstacles().size()) - 1));
  }
  return &*scene.obstacles.insert(at, {.id = id, .shape = mission_world.obstacles()[id]});
}

Result<void> make(Scene& scene, const AddObstacle& add, const World&, UtcTime) {
  const auto at = find_obstacle(scene.obstacles, scene.next_id);  // bodies have larger ids
  scene.obstacles.insert(at, {.id = scene.next_id++, .shape = add.shape});
  return {};
}

/// A move starts from the present position, which also ends a move under way. Speed is constant
/// over the whole move. Receivers would refuse an obstacle beyond their limits, and with it every
/// later scene.
Result<void> make(Scene& scene, const MoveObstacle& move, const World& mission_world, UtcTime now) {
  const auto found = find(scene, move.obstacle, mission_world);
  if (!found) return tl::unexpected(found.error());
  SceneObstacle& obstacle = **found;
  obstacle.shape = obstacle.at(now);
  obstacle.velocity_mps = Vec2::Zero();
  obstacle.moving_from = obstacle.moving_until = now;
  const Duration over = from_seconds(move.over_s);
  const Obstacle moved = shifted(obstacle.shape, move.by_m);
  const bool is_even = over > Duration::zero();
  if (is_even) {
    obstacle.velocity_mps = move.by_m / move.over_s;
    obstacle.moving_until = now + over;
  } else {
    obstacle.shape = moved;
  }
  if (!is_within_limits(moved) || !(obstacle.velocity_mps.norm() <= Scene::kMaxSpeed_mps)) {
    return fail(ErrorCode::kBadInput,
                fmt::format("the move leads farther than {:g} m from the origin or is faster than "
                            "{:g} m/s",
                            Scene::kMaxCoordinate_m, Scene::kMaxSpeed_mps));
  }
  return {};
}

/// Only obstacles of the mission file are remembered as removed; for an added one its absence is
/// enough.
Result<void> make(Scene& scene, const RemoveObstacle& remove, const World& mission_world, UtcTime) {
  const auto found = find(scene, remove.obstacle, mission_world);
  if (!found) return tl::unexpected(found.error());
  scene.obstacles.erase(scene.obstacles.begin() + (*found - scene.obstacles.data()));
  if (remove.obstacle < mission_world.obstacles().size()) scene.removed.push_back(remove.obstacle);
  return {};
}

Result<void> make(Scene& scene, const GoTo& go, const World&, UtcTime) {
  scene.goal = go.goal;
  return {};
}

Result<void> make(Scene& scene, const SetRisk& risk, const World&, UtcTime) {
  scene.risk_alpha = risk.alpha;
  return {};
}

/// A robot that falls again replaces its body in place.
Result<void> make(Scene& scene, const AddBody& add, const World&, UtcTime) {
  const std::uint32_t id = body_id(add.robot);
  const auto at = find_obstacle(scene.obstacles, id);
  if (at != scene.obstacles.end() && at->id == id) {
    at->shape = add.shape;
  } else {
    scene.obstacles.insert(at, {.id = id, .owner = add.robot, .shape = add.shape});
  }
  return {};
}

Result<void> make(Scene& scene, const ClearBody& clear, const World&, UtcTime) {
  const std::uint32_t id = body_id(clear.robot);
  const auto at = find_obstacle(scene.obstacles, id);
  if (at == scene.obstacles.end() || at->id != id) {
    return fail(ErrorCode::kBadInput,
                fmt::format("robot {} has no body among the obstacles", clear.robot.value()));
  }
  scene.obstacles.erase(at);
  return {};
}

}  // namespace

/// In the order of the alternatives of SceneChange.
std::string_view name_of(const SceneChange& change) {
  constexpr std::string_view kNames[] = {
      "add_obstacle", "move_obstacle", "remove_obstacle", "goto", "risk", "add_body", "clear"};
  return kNames[change.index()];
}

/// Clamping the time gives the shift before, during and after the move in one formula.
Vec2 SceneObstacle::shift_m(UtcTime now) const {
  const Duration moved = std::clamp(now, moving_from, moving_until) - moving_from;
  return to_seconds(moved) * velocity_mps;
}

Obstacle SceneObstacle::at(UtcTime now) const { return shifted(shape, shift_m(now)); }

bool Scene::moves(UtcTime now) const {
  return std::any_of(obstacles.begin(), obstacles.end(),
                     [&](const SceneObstacle& o) { return o.moves(now); });
}

Scene first_scene(std::size_t mission_obstacles) {
  Scene scene;
  scene.next_id = static_cast<std::uint32_t>(mission_obstacles);
  return scene;
}

/// Works on a copy, so that a refused change leaves the scene as it was. The bounds are those of
/// the scene message on the wire.
Result<Scene> after(const Scene& scene, const SceneChange& change, const World& mission_world,
                    UtcTime now) {
  Scene next = scene;
  const auto made =
      std::visit([&](const auto& c) { return make(next, c, mission_world, now); }, change);
  if (!made) return tl::unexpected(made.error());
  std::size_t vertices = 0;
  for (const SceneObstacle& obstacle : next.obstacles) vertices += vertices_of(obstacle.shape);
  if (next.obstacles.size() > Scene::kMaxObstacles || next.removed.size() > Scene::kMaxRemoved ||
      vertices > Scene::kMaxVertices) {
    return fail(
        ErrorCode::kBadInput,
        fmt::format("at most {} obstacles with {} vertices may be added or moved, bodies of "
                    "robots included, and {} removed",
                    Scene::kMaxObstacles, Scene::kMaxVertices, Scene::kMaxRemoved));
  }
  // The clock may step back; versions must ascend nevertheless.
  next.version =
      std::max(scene.version + 1, static_cast<std::uint64_t>(now.time_since_epoch().count()));
  return next;
}

/// Merges two lists sorted by number: obstacles of the mission file and changed ones. Bodies have
/// the largest numbers, so they end up last, as World::make() requires.
World world_at(const World& mission_world, const Scene& scene, UtcTime now) {
  std::vector<Obstacle> obstacles;
  std::vector<Vec2> velocities_mps;
  const auto take = [&](const SceneObstacle& o) {
    obstacles.push_back(o.at(now));
    velocities_mps.push_back(o.moves(now) ? o.velocity_mps : Vec2::Zero());
  };
  auto changed = scene.obstacles.begin();
  for (std::uint32_t id = 0; id < mission_world.obstacles().size(); ++id) {
    if (changed != scene.obstacles.end() && changed->id == id) {
      take(*changed++);
    } else if (std::find(scene.removed.begin(), scene.removed.end(), id) == scene.removed.end()) {
      obstacles.push_back(mission_world.obstacles()[id]);
      velocities_mps.emplace_back(Vec2::Zero());
    }
  }
  for (; changed != scene.obstacles.end(); ++changed) take(*changed);
  const auto bodies = std::count_if(scene.obstacles.begin(), scene.obstacles.end(),
                                    [](const SceneObstacle& o) { return o.owner.has_value(); });
  Result<World> world = World::make(mission_world.bounds_m(), std::move(obstacles), velocities_mps,
                                    static_cast<std::size_t>(bodies));
  SWARM_ASSERT(world.has_value());  // shapes were checked when they were read
  return *std::move(world);
}

/// A moving obstacle is represented by three copies, at the begin, the middle and the end of the
/// period. What it covers between them is not represented.
World world_during(const World& mission_world, const Scene& scene, UtcTime begin, Duration span) {
  const World now = world_at(mission_world, scene, begin);
  std::vector<Obstacle> obstacles = now.obstacles();
  for (const SceneObstacle& o : scene.obstacles) {
    if (o.shift_m(begin) == o.shift_m(begin + span)) continue;
    obstacles.push_back(o.at(begin + span / 2));
    obstacles.push_back(o.at(begin + span));
  }
  Result<World> world = World::make(mission_world.bounds_m(), std::move(obstacles));
  SWARM_ASSERT(world.has_value());
  return *std::move(world);
}

/// A phase begins at each scene and at the end of each move, unless the next scene comes first.
std::vector<WorldPhase> world_phases(const World& mission_world, const std::vector<Scene>& scenes) {
  std::vector<WorldPhase> phases;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Scene scene = without_bodies(scenes[i]);
    const auto stamp = [&](std::size_t k) {
      return UtcTime(Duration(static_cast<std::int64_t>(scenes[k].version)));
    };
    std::vector<UtcTime> begins{stamp(i)};
    for (const SceneObstacle& o : scene.obstacles) {
      const bool ends_here = i + 1 == scenes.size() || o.moving_until < stamp(i + 1);
      if (o.moving_until > stamp(i) && ends_here) begins.push_back(o.moving_until);
    }
    std::sort(begins.begin(), begins.end());
    begins.erase(std::unique(begins.begin(), begins.end()), begins.end());
    for (const UtcTime begin : begins) {
      phases.push_back({begin, world_at(mission_world, scene, begin)});
    }
  }
  return phases;
}

/// A scene in which everything that ever changed is removed; numbers of added obstacles among them
/// have no effect.
World lasting_world(const World& mission_world, const std::vector<Scene>& scenes) {
  Scene without = first_scene(mission_world.obstacles().size());
  for (const Scene& scene : scenes) {
    without.removed.insert(without.removed.end(), scene.removed.begin(), scene.removed.end());
    for (const SceneObstacle& o : scene.obstacles) without.removed.push_back(o.id);
  }
  return world_at(mission_world, without, {});
}

}  // namespace swarm
