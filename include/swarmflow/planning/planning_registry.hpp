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

/// How many plans a method will be asked for.
enum class PlanningUse {
  kInFlight,  ///< again and again, as the scene changes: what was learnt of the map is worth
              ///< keeping
  kOnePlan,   ///< one plan only, as fast as possible
};

/// What a factory may read to make a method.
struct MethodContext {
  const Mission& mission;  ///< with the options of the method; outlives the call only
  SwarmLimits limits;      ///< what the robots' bodies can follow
  PlanningUse use = PlanningUse::kInFlight;

  /// The keys that the method declares, as its mission sets them.
  const OptionValues& options() const { return mission.planner.options; }
};

/// A planning method as a mission names it by planner.method.
struct PlanningEntry {
  ComponentSpec spec;  ///< its keys are those that it reads from mission.planner.options
  /// kBadInput says which option of the mission is wrong.
  std::function<Result<std::unique_ptr<PlanningMethod>>(const MethodContext&)> make;
};

/// The planning methods of a program by name: the built-in ones and a guest's register alike.
class PlanningRegistry {
 public:
  /// \pre no entry of this name is there, and its keys are not those of another with another spec
  void add(PlanningEntry entry);

  const std::vector<PlanningEntry>& all() const { return entries_; }
  Components specs() const;
  /// What the planner's program knows of a mission file: not the components of the robots.
  Catalogue catalogue() const;

  /// The method that the mission names. kBadInput for an unknown name lists those that are known;
  /// otherwise errors are the factory's.
  Result<std::unique_ptr<PlanningMethod>> make(const Mission& mission, PlanningUse use) const;

 private:
  std::vector<PlanningEntry> entries_;
};

}  // namespace swarm::planner
