// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/scene_bodies.hpp"

#include <algorithm>

namespace swarm {

bool has_body(const Scene& scene, RobotId robot) {
  // From the end, where the few bodies are.
  return std::any_of(scene.obstacles.rbegin(), scene.obstacles.rend(),
                     [&](const SceneObstacle& o) { return o.owner == robot; });
}

Scene without_bodies(Scene scene) {
  std::erase_if(scene.obstacles, [](const SceneObstacle& o) { return o.owner.has_value(); });
  return scene;
}

// One unsigned comparison tests first ≤ id < first + robots: smaller ids wrap around to large
// numbers.
Scene without_bodies_of(Scene scene, RobotId first, std::uint32_t robots) {
  std::erase_if(scene.obstacles, [&](const SceneObstacle& o) {
    return o.owner && o.owner->value() - first.value() < robots;
  });
  return scene;
}

double frozen_body_radius_m(const Mission& mission, RobotId robot) {
  const BodySpec& body = body_of(mission.robots, robot);
  const double drives_s = 1.0 / mission.link.status_hz + 2.0 / mission.control.rate_hz;
  const double fastest_mps = body.speed_max_mps;
  const double brakes_m = body.model == "single_integrator"
                              ? 0.0
                              : fastest_mps * fastest_mps / (2.0 * body.acceleration_max_mps2);
  constexpr double kRounding_m = 1e-6;
  return body.radius_m + fastest_mps * drives_s + brakes_m + kRounding_m;
}

// Follows the scenes in order of time. A body that is missing from a scene was cleared at that
// scene; one that is present and not open yet begins there. A later shape of an open body replaces
// the earlier one.
std::vector<FallenBody> bodies_of(const std::vector<Scene>& scenes) {
  std::vector<FallenBody> bodies;
  for (const Scene& scene : scenes) {
    const UtcTime at(Duration(static_cast<std::int64_t>(scene.version)));
    const auto in_scene = [&](const FallenBody& body) {
      return std::find_if(scene.obstacles.begin(), scene.obstacles.end(),
                          [&](const SceneObstacle& o) { return o.owner == body.robot; });
    };
    for (FallenBody& body : bodies) {
      if (!body.cleared && in_scene(body) == scene.obstacles.end()) body.cleared = at;
    }
    for (const SceneObstacle& o : scene.obstacles) {
      const auto* circle = std::get_if<Circle>(&o.shape);
      if (!o.owner || circle == nullptr) continue;
      const auto known = std::find_if(bodies.begin(), bodies.end(), [&](const FallenBody& body) {
        return body.robot == *o.owner && !body.cleared;
      });
      if (known == bodies.end()) {
        bodies.push_back({.robot = *o.owner, .shape = *circle, .from = at});
      } else {
        known->shape = *circle;
      }
    }
  }
  return bodies;
}

}  // namespace swarm
