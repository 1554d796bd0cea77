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

/// The robot that a driver is made for. Valid during the call.
struct DriverContext {
  const Mission& mission;
  RobotId robot;
  Vec2 position_m =
      Vec2::Zero();  ///< its place at the start, or where it was last of a respawned one
  SteadyTime now;
  std::uint64_t seed = 0;  ///< of its own noise

  const BodySpec& body() const { return body_of(mission.robots, robot); }
  /// The keys that the driver declares, as the mission sets them for this robot.
  const OptionValues& options() const { return body().options; }
};

/// A driver as a mission names it by robots.model.
struct DriverEntry {
  ComponentSpec spec;  ///< with the lag of the body
  std::function<Result<std::unique_ptr<Driver>>(const DriverContext&)> make;
};

/// The drivers that a robot program has, by name: the built-in ones and a guest's register alike.
class DriverRegistry {
 public:
  /// \pre no entry of this name is there
  void add(DriverEntry entry);

  /// Null if there is none of this name.
  const DriverEntry* find(std::string_view name) const;
  const std::vector<DriverEntry>& all() const { return entries_; }
  Components specs() const;

 private:
  std::vector<DriverEntry> entries_;
};

/// single_integrator, double_integrator and unicycle: simulated bodies.
void register_builtin_drivers(DriverRegistry& registry);

}  // namespace swarm::agent
