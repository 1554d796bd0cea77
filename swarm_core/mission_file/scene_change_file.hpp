// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "swarm_core/mission_file/mission_shapes.hpp"
#include "swarmflow/mission/scene.hpp"

namespace swarm {

/// Reads the keys of a change, in a script and on the command line alike:
///
///   add_obstacle      polygon_m or circle_m
///   move_obstacle     obstacle, by_m, over_s (0 = at once)
///   remove_obstacle   obstacle
///   goto              goal, a mixture
///   risk              alpha
///   add_body          robot, circle_m; by the launcher alone, for its scene log
///   clear             robot
///
/// Empty after a violation, and when `action` is none of these. `at` is where the mapping is.
std::optional<SceneChange> read_scene_change(std::string_view action, yaml::MapReader& keys,
                                             const std::string& path, yaml::Position at,
                                             ShapeReader& shapes, const World& mission_world,
                                             yaml::Violations& violations);

/// Reads a change from a command line: `action` and its keys as a YAML mapping, as in a script:
/// `circle_m: {center: [60, 40], radius: 3}`. Braces around it may be left out, and `clear 7` is
/// short for `clear robot: 7`.
Result<SceneChange> parse_scene_change(const std::string& action, const std::string& keys,
                                       const World& mission_world);

/// The keys of a change as one line of YAML, without braces.
std::string keys_of(const SceneChange& change);

}  // namespace swarm
