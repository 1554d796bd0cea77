// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm {

/// Size of the largest mission file that is read [bytes].
inline constexpr std::size_t kMaxMissionBytes = 16U << 20U;

/// Reads a mission from YAML. Strict: every key is known, used once, in range and of the right
/// type; the world is well-formed; start and goal lie inside it. Never throws.
/// \param yaml text of the file
/// \param name name of the file, for messages only
/// \param directory where the bitmap of a goal is looked for
/// \param catalogue components that the mission may name, and their keys, whose defaults are set
///   where the file leaves them out. By default names and keys of components are accepted as they
///   are: right for the mission of a run, which its launcher has checked.
/// \param robots number of robots instead of the file's `robots.count`, as of a command line; all
///   other keys are checked against it
/// \return kBadInput with *all* violations, one per line, as `file:line:column: what is wrong;
///   what would be right`
Result<Mission> parse_mission(std::string_view yaml, const std::string& name,
                              const std::filesystem::path& directory = {},
                              const Catalogue& catalogue = open_catalogue(),
                              std::optional<std::uint32_t> robots = std::nullopt);

/// Reads and parses a mission file; its bitmaps are looked for beside it. Errors as of
/// parse_mission(), kBadInput too if the file cannot be read.
Result<Mission> load_mission(const std::filesystem::path& file,
                             const Catalogue& catalogue = open_catalogue(),
                             std::optional<std::uint32_t> robots = std::nullopt);

/// The mission as YAML with every default written out, which parse_mission() reads back to an equal
/// mission: a logged run does not depend on later defaults. Of options that components declare only
/// those are written that the mission sets.
std::string to_yaml(const Mission& mission);

}  // namespace swarm
