// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "swarmflow/mission/mission_file.hpp"

namespace swarm::test {

/// ROVER's scenario 1, 2 or 3, as its mission file has it.
inline Mission rover_scene(int scenario) {
  return load_mission(std::string(SWARM_SOURCE_DIR) + "/deploy/missions/rover_scenario" +
                      std::to_string(scenario) + "_standin.yaml")
      .value();
}

}  // namespace swarm::test
