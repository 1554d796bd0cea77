// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/options.hpp"

namespace swarm {

/// How long the body of a driver takes until it moves at the velocity it was commanded: so much
/// earlier its safety filter brakes, and so much more room its plans leave. A declaration and no
/// function, as programs that do not have the driver use it too.
struct LagSpec {
  double fixed_s = 0.0;      ///< whatever the command
  bool accelerates = false;  ///< and from full speed to rest, v_max / a_max
  bool turns = false;        ///< and a turn by a quarter, π / 2 ω_max
  bool operator==(const LagSpec&) const = default;
};

/// A component as a mission may ask for it: its name and the options it reads.
struct ComponentSpec {
  std::string name;
  std::string doc;  ///< one sentence
  std::vector<OptionSpec> options;
  LagSpec lag{};  ///< of a driver
};

/// The components of one section of the mission file, by name.
using Components = std::vector<ComponentSpec>;

/// Null if there is none of this name.
const ComponentSpec* find_component(const Components& components, std::string_view name);

/// What the programs of a run can do: the names and keys that a mission file may use. A program
/// describes itself by `--describe`; the launcher checks a mission against what the programs that
/// it is going to start describe.
///
/// In an open section names and keys that are not known are accepted as they are: a robot program
/// does not know the planner's keys, and a recording's programs may not be at hand.
struct Catalogue {
  Components planning_methods;  ///< planner.method and keys beside it
  Components control_methods;   ///< control.method and keys beside it
  Components drivers;           ///< robots.model and keys beside it
  bool planning_is_open = false;
  bool robots_are_open = false;  ///< control methods and drivers
};

/// A catalogue that accepts any name and any scalar key in all these sections.
Catalogue open_catalogue();

/// As JSON, for `--describe`; `describe` reads back to an equal catalogue.
std::string to_json(const Catalogue& catalogue);
Result<Catalogue> catalogue_from_json(std::string_view text, const std::string& name);

}  // namespace swarm
