// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <string_view>
#include <vector>

#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/robot/control_slot.hpp"

namespace swarm::agent {

/// What a control method is prepared for. Valid during the call.
struct ControlContext {
  const Mission& mission;
  const BodySpec& body;
  /// The keys of its section that the method declares, as its mission sets them.
  const OptionValues& options() const { return mission.control.options; }
};

/// A control method prepared for robots with the same body.
struct PreparedControl {
  /// Makes the method of one robot. Called once for each of them.
  std::function<ControlSlot()> make;
  /// Distance beyond which other robots do not matter to the method, centre to centre [m]; no robot
  /// is received from beyond its communication radius.
  double reach_m = std::numeric_limits<double>::infinity();
  /// Surface gap below which other robots press: at least so near they are received as often as the
  /// safety filter needs them [m].
  double press_gap_m = 1.0;
  /// Whether ControlView::planned_density is read.
  bool reads_density = false;
};

/// A control method as a mission names it.
struct ControlEntry {
  ComponentSpec spec;
  std::function<Result<PreparedControl>(const ControlContext&)> prepare;
};

/// The control methods that a robot program has, by name: the built-in ones and a guest's register
/// alike.
class ControlRegistry {
 public:
  /// \pre no entry of this name is there, and its keys are not those of another with another spec
  void add(ControlEntry entry);

  /// Null if there is none of this name.
  const ControlEntry* find(std::string_view name) const;
  const std::vector<ControlEntry>& all() const { return entries_; }
  Components specs() const;

 private:
  std::vector<ControlEntry> entries_;
};

/// apf, crops and intermittent_diffusion.
void register_builtin_control(ControlRegistry& registry);
const ControlRegistry& builtin_control();

}  // namespace swarm::agent
