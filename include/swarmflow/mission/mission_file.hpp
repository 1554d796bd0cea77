// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm {

/// Largest mission file read.
inline constexpr std::size_t kMaxMissionBytes = 16U << 20U;

/// Reads a mission from YAML. Strict: every key is known, used once, in range and of the right
/// type; the world is well-formed; start and goal lie inside it. On failure the error holds *all*
/// violations, one per line, as `file:line:column: what is wrong; what would be right`. `name` is
/// only used in messages; a goal's bitmap is looked for in `directory`. `catalogue`: the components
/// that the mission may name, and their keys, whose defaults are set where the file leaves them
/// out. By default names and keys of components are taken as they are: right for the mission of a
/// run, which its launcher has checked. Never throws.
Result<Mission> parse_mission(std::string_view yaml, const std::string& name,
                              const std::filesystem::path& directory = {},
                              const Catalogue& catalogue = open_catalogue());

/// Reads and parses a file.
Result<Mission> load_mission(const std::filesystem::path& file,
                             const Catalogue& catalogue = open_catalogue());

/// The mission with every default written out, as YAML that parse_mission() reads back to an equal
/// mission (defends logged runs against changing defaults).
std::string to_yaml(const Mission& mission);

}  // namespace swarm
