// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm {

/// A rule between several keys that a mission violates.
struct BrokenRule {
  std::vector<std::string> keys;  ///< paths of the keys it ties, the most likely culprit first
  std::string message;            ///< the wrong value and the values that would be right
};

/// Least communication radius of the robots with this body, between centres [m]: the safety filter
/// begins to brake at a surface gap of m + (v + v′)·dt/γ, and until its next state update
/// (send_interval_max_s) a pair of robots may approach at v + v′. v is the body's largest speed, v′
/// that of the fastest robot; the other robot is as large as the largest one.
double least_communication_radius_m(const Mission& mission, const BodySpec& body);

/// All rules between keys that `mission` violates. Each single value must be in its range.
std::vector<BrokenRule> broken_rules(const Mission& mission);

/// The rules between keys of the components of a section (OptionSpec::at_most) that the values
/// violate. A value that is not set counts as the key's default.
std::vector<BrokenRule> broken_rules(const std::string& section, const Components& components,
                                     const OptionValues& values);

}  // namespace swarm
