// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "swarmflow/mission/catalogue.hpp"

namespace swarm {

/// All scalar keys of a mission file as Markdown: those of the mission's own tables and those of
/// the catalogue's components, grouped by section and component, one row for each key.
std::string mission_keys_markdown(const Catalogue& catalogue);

}  // namespace swarm
