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

/// What a control method is prepared for. Valid during the call: copy what is needed later.
struct ControlContext {
  const Mission& mission;  ///< the mission, all defaults filled in
  const BodySpec& body;    ///< the body of the robots: radius, largest speed, noise
  /// The options under `control:` that a registered method declares, as far as the mission sets
  /// them: OptionTable::read() gives them with their defaults.
  const OptionValues& options() const { return mission.control.options; }
};

/// A control method prepared for robots with the same body.
struct PreparedControl {
  /// Makes the method of one robot. Called once for each of them, and must not fail: what can go
  /// wrong belongs into ControlEntry::prepare.
  std::function<ControlSlot()> make;
  /// Distance between centres beyond which other robots do not matter to the method [m]:
  /// ControlView::neighbours has no others, which saves time in dense regions. By default all
  /// robots within the communication radius are passed; the safety filter has its own distance.
  double reach_m = std::numeric_limits<double>::infinity();
  /// Surface gap below which other robots push [m]: their states are received at the full rate at
  /// least from this near.
  double press_gap_m = 1.0;
  /// Whether ControlView::planned_density is read: then it is computed at every tick, once a
  /// process.
  bool reads_density = false;
};

/// A control method as a mission names it.
struct ControlEntry {
  /// Name (the value of `control.method`), documentation and options. An option may have the key of
  /// another method's only if both specs of it are equal.
  ComponentSpec spec;
  /// Prepares the method, once for every kind of body of the mission, when the program starts.
  /// kBadInput if an option of the mission is wrong: the program ends with that message.
  std::function<Result<PreparedControl>(const ControlContext&)> prepare;
};

/// The control methods that a robot program has, by name. Built-in methods and those of others are
/// registered in the same way.
class ControlRegistry {
 public:
  /// Adds a method. Pointers from find() become invalid.
  /// \pre entry.prepare is set, the name is new, options that share a key with another method's
  /// have
  ///   the same spec, and a shape_tolerance is the key of an option that is a number; asserted
  void add(ControlEntry entry);

  /// The method of this name; null if there is none. O(entries).
  const ControlEntry* find(std::string_view name) const;
  /// All methods, in the order of registration.
  const std::vector<ControlEntry>& all() const { return entries_; }
  /// Names and options of all methods, for a Catalogue.
  Components specs() const;

 private:
  std::vector<ControlEntry> entries_;
};

/// Adds the built-in methods: apf, crops and intermittent_diffusion.
/// \pre none of these names is taken, asserted
void register_builtin_control(ControlRegistry& registry);

/// A registry of the built-in methods alone, made at the first call; shared and immutable, so safe
/// from any thread. To add methods start from builtin_robots().
const ControlRegistry& builtin_control();

}  // namespace swarm::agent
