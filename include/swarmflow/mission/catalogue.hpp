// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/options.hpp"

namespace swarm {

/// How the time that a body takes to reach a commanded velocity depends on its limits, see
/// declared_lag_s(). A declaration and not a function, since programs without the driver use it
/// too.
struct LagSpec {
  double fixed_s = 0.0;      ///< part that does not depend on the command [s]
  bool accelerates = false;  ///< adds the time from rest to full speed, v_max / a_max
  bool turns = false;        ///< adds the time of a quarter turn, (π/2) / ω_max
  /// Whether all members are the same.
  bool operator==(const LagSpec&) const = default;
};

/// A component that a mission may name, and the options that it reads.
struct ComponentSpec {
  std::string name;                 ///< value of planner.method, control.method or robots.model
  std::string doc;                  ///< one sentence for help and documentation
  std::vector<OptionSpec> options;  ///< keys that it reads from its section
  LagSpec lag{};                    ///< of a driver: how late its body follows a command
  /// Of a control method whose robots fill the drawing of the goal and stop where they find room:
  /// the key of its option that holds the tolerance of the shape function [m²]. Within it a robot
  /// has arrived, whichever Gaussian of the goal is nearest. Empty: a robot arrives in the 99 %
  /// ellipse of the goal's component that its path leads to.
  std::string shape_tolerance{};
};

/// The components of one section of the mission file, by name.
using Components = std::vector<ComponentSpec>;

/// The component of this name; null if there is none. O(components).
const ComponentSpec* find_component(const Components& components, std::string_view name);

/// What the programs of a run can do: the names and keys that a mission file may use. A program
/// prints its own by `--describe`; the launcher checks a mission against those of the programs that
/// it is going to start. Built-in components are always known and need not be listed.
///
/// In an open section unknown names and keys are accepted as they are: a robot program does not
/// know the planner's keys, and the programs of a recording may not be at hand.
struct Catalogue {
  Components planning_methods;    ///< values of planner.method and keys of `planner:`
  Components control_methods;     ///< values of control.method and keys of `control:`
  Components drivers;             ///< values of robots.model and keys of `robots:`
  bool planning_is_open = false;  ///< whether `planner:` is an open section
  bool robots_are_open = false;   ///< whether `control:` and `robots:` are open sections
};

/// A catalogue that accepts any name and any scalar key in all these sections, unchecked.
Catalogue open_catalogue();

/// The components as JSON, for `--describe`. Which sections are open is not written; ranges must be
/// finite.
std::string to_json(const Catalogue& catalogue);
/// Reads what to_json() wrote. kBadInput if it is not such JSON; `name` is the program that printed
/// it, for the message.
Result<Catalogue> catalogue_from_json(std::string_view text, const std::string& name);

}  // namespace swarm
