// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/robot/driver.hpp"

namespace swarm::agent {

/// The robot that a driver is made for. Valid during the call: copy what is needed later.
struct DriverContext {
  const Mission& mission;  ///< the mission, all defaults filled in
  RobotId robot;           ///< the robot's number
  /// Position at which the mission starts the robot, or where the body of a robot came to
  /// rest whose process was restarted [m]. A simulated body begins there; a real one reports its
  /// own.
  Vec2 position_m = Vec2::Zero();
  SteadyTime now;          ///< present time, at or before the first Driver::measure()
  std::uint64_t seed = 0;  ///< for noise of a simulated body; differs between robots

  /// The robot's body: radius, largest speed, noise.
  const BodySpec& body() const { return body_of(mission.robots, robot); }
  /// The options under `robots:` that a registered driver declares, as far as the mission sets them
  /// for this robot or its group: OptionTable::read() gives them with their defaults.
  const OptionValues& options() const { return body().options; }
};

/// A driver as a mission names it by robots.model.
struct DriverEntry {
  ComponentSpec spec;  ///< name (the value of `robots.model`), documentation, options and lag
  /// Makes the driver of one robot; Driver::start() is called next. An error ends the program with
  /// its message.
  std::function<Result<std::unique_ptr<Driver>>(const DriverContext&)> make;
};

/// The drivers that a robot program has, by name. Built-in drivers and those of others are
/// registered in the same way.
class DriverRegistry {
 public:
  /// Adds a driver. Pointers from find() become invalid.
  /// \pre entry.make is set and the name is new; asserted
  void add(DriverEntry entry);

  /// The driver of this name; null if there is none. O(entries).
  const DriverEntry* find(std::string_view name) const;
  /// All drivers, in the order of registration.
  const std::vector<DriverEntry>& all() const { return entries_; }
  /// Names and options of all drivers, for a Catalogue.
  Components specs() const;

 private:
  std::vector<DriverEntry> entries_;
};

/// Adds the built-in simulated bodies: single_integrator, double_integrator and unicycle.
/// \pre none of these names is taken, asserted
void register_builtin_drivers(DriverRegistry& registry);

}  // namespace swarm::agent
