// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "swarmflow/mission/scene.hpp"

/// The changes of a run's scene, one line of JSON each: {"utc_ns", "action", "keys"}, with actions
/// and keys as in a script. Audits replay them.
namespace swarm {

/// One change as a line, with the newline.
std::string scene_log_line(std::uint64_t version, const SceneChange& change);

/// The scenes of a mission, the first one as in the mission file. A line that is not JSON, of which
/// a full disk took a part, is left out. One that is not a change, or a change that was not
/// possible, ends the list, because the lines after it refer to its result.
std::vector<Scene> replay_scene_log(std::string_view text, const World& mission_world);

}  // namespace swarm
