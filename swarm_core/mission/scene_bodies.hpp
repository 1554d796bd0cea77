// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/scene.hpp"

/// The bodies of dead and silent robots: obstacles with an owner.
namespace swarm {

/// Whether a robot's body is an obstacle.
bool has_body(const Scene& scene, RobotId robot);

/// The scene without the bodies of all robots.
Scene without_bodies(Scene scene);

/// The scene without the bodies of these robots: a robot does not avoid its own body.
Scene without_bodies_of(Scene scene, RobotId first, std::uint32_t robots);

/// The largest radius [m] of the circle that covers the body of a robot which does not drive on:
/// its position may be 1/status_hz seconds old, then the last command runs out and the body brakes.
/// A wider circle is that of a robot which may have been cut off and have driven on.
double frozen_body_radius_m(const Mission& mission, RobotId robot);

/// A body that was an obstacle for a while.
struct FallenBody {
  RobotId robot;
  Circle shape;                      ///< the robot's body is somewhere inside
  UtcTime from{};                    ///< it is an obstacle from then on
  std::optional<UtcTime> cleared{};  ///< until then; empty: to the end of the run
};

/// All bodies of a run that went through these scenes, by the time at which they became obstacles.
/// A robot that falls twice appears twice.
std::vector<FallenBody> bodies_of(const std::vector<Scene>& scenes);

}  // namespace swarm
