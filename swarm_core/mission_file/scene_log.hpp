// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "swarmflow/mission/scene.hpp"

/// The changes of a run's scene, one line of JSON each: {"utc_ns", "action", "keys"}, the words of
/// a script. Audits replay them.
namespace swarm {

/// A line, with its end.
std::string scene_log_line(std::uint64_t version, const SceneChange& change);

/// The scenes a mission went through, the first as in the mission file. A line that is no change,
/// or none that was possible, ends them: what follows would be read wrongly.
std::vector<Scene> replay_scene_log(std::string_view text, const World& mission_world);

}  // namespace swarm
