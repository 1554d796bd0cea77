// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "planner_service/planning_method.hpp"
#include "swarm_core/base/result.hpp"
#include "swarm_core/mission/body_limits.hpp"
#include "swarm_core/mission/mission.hpp"

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
};

/// Makes a method. kBadInput says which option of the mission is wrong.
using PlanningFactory =
    std::function<Result<std::unique_ptr<PlanningMethod>>(const MethodContext&)>;

/// The planning methods of a program by name. The built-in ones enter it by
/// register_builtin_methods(), a guest's by the same add().
class PlanningRegistry {
 public:
  struct Entry {
    std::string summary;  ///< one line of documentation
    PlanningFactory make;
  };

  /// \pre the name is new
  void add(std::string name, std::string summary, PlanningFactory factory);

  const std::map<std::string, Entry, std::less<>>& entries() const { return entries_; }

  /// The method that the mission names. kBadInput for an unknown name lists those that are known;
  /// otherwise errors are the factory's.
  Result<std::unique_ptr<PlanningMethod>> make(const Mission& mission, PlanningUse use) const;

 private:
  std::map<std::string, Entry, std::less<>> entries_;
};

}  // namespace swarm::planner
