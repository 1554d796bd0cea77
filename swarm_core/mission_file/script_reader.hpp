// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "swarm_core/mission_file/mission_shapes.hpp"
#include "swarm_core/mission_file/yaml_reader.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm {

/// What a script refers to.
struct ScriptContext {
  const World* world = nullptr;  ///< null if the file's world is wrong: then events are not checked
  std::uint32_t robots = 0;      ///< number of robots, for events that name one
};

/// Reads the script of a mission: events in order of time, each of which is a command or a change
/// of the scene that is possible at its time.
std::vector<ScriptEvent> read_script(const yaml::Node& node, const ScriptContext& context,
                                     ShapeReader& shapes, yaml::Violations& violations);

}  // namespace swarm
