// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm {

/// A rule between several keys that a mission breaks.
struct BrokenRule {
  std::vector<std::string> keys;  ///< paths of the keys it ties, the most likely culprit first
  std::string message;            ///< what is wrong; what would be right
};

/// Distance between two robots' centres from which they must hear each other [m]: the safety filter
/// begins to brake at surface gap m + 2·v_max·dt/γ, and until its next word (send_interval_max_s) a
/// pair may close in at 2·v_max.
double least_communication_radius_m(const Mission& mission);

/// All rules between keys that `mission` breaks; its single values are taken to be in range.
std::vector<BrokenRule> broken_rules(const Mission& mission);

/// The rules between keys of the components of a section (OptionSpec::at_most) that the values
/// break. A value that is not set is the key's default.
std::vector<BrokenRule> broken_rules(const std::string& section, const Components& components,
                                     const OptionValues& values);

}  // namespace swarm
