// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/body_limits.hpp"
#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/planning/planning_method.hpp"

namespace swarm::planner {

/// How many plans will be requested from a method.
enum class PlanningUse {
  kInFlight,  ///< one after the other, as the scene changes: data about the map is worth keeping
  kOnePlan,   ///< one plan only, as fast as possible
};

/// What a factory may read to make a method.
struct MethodContext {
  /// The mission, all defaults filled in; valid during the call.
  const Mission& mission;
  SwarmLimits limits;  ///< density and speed of plans that the robots' bodies can follow
  PlanningUse use = PlanningUse::kInFlight;  ///< how many plans will be requested

  /// The method's own options; OptionTable::read() gives them with their defaults.
  const OptionValues& options() const { return mission.planner.options; }
};

/// A planning method as a mission names it by `planner.method`.
struct PlanningEntry {
  ComponentSpec spec;  ///< name, documentation, and the options read from mission.planner.options
  /// Makes the method of a mission, once per program; cheap, as planning itself is plan().
  /// kBadInput, with the key in the message, if an option of the mission is wrong.
  std::function<Result<std::unique_ptr<PlanningMethod>>(const MethodContext&)> make;
};

/// The planning methods that a planner program has, by name. Built-in methods and those of others
/// are registered in the same way.
class PlanningRegistry {
 public:
  /// Adds a method. \pre entry.make is set, the name is new, and a key that another method has too
  /// has the same spec; asserted
  void add(PlanningEntry entry);

  /// All methods, in the order of registration.
  const std::vector<PlanningEntry>& all() const { return entries_; }
  /// Names and options of all methods, for a Catalogue.
  Components specs() const;
  /// What a planner program knows of a mission file: its methods, and any component of the robots.
  Catalogue catalogue() const;

  /// Makes the method that the mission names.
  /// \return kBadInput for an unknown name, with the known ones in the message; otherwise the
  ///   factory's errors
  Result<std::unique_ptr<PlanningMethod>> make(const Mission& mission, PlanningUse use) const;

 private:
  std::vector<PlanningEntry> entries_;
};

}  // namespace swarm::planner
