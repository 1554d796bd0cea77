// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/shape_field.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/mission/phase.hpp"
#include "swarmflow/mission/scene.hpp"
#include "swarmflow/mission/sections/control.hpp"
#include "swarmflow/mission/sections/criteria.hpp"
#include "swarmflow/mission/sections/launcher.hpp"
#include "swarmflow/mission/sections/link.hpp"
#include "swarmflow/mission/sections/plan_clock.hpp"
#include "swarmflow/mission/sections/planner.hpp"
#include "swarmflow/mission/sections/robots.hpp"
#include "swarmflow/mission/sections/safety.hpp"
#include "swarmflow/mission/sections/timing.hpp"

namespace swarm {

// The content of a mission file, with its defaults. Each section has a header of its own in
// sections/: a struct with one member per key of the file, of the same name, and below it the table
// of its scalar keys. Ranges are checked when a file is read. Components take their own options,
// never the Mission.

struct Mission;
/// The largest communication radius of any robot [m]. O(groups).
double largest_communication_radius_m(const Mission& mission);

/// What script and operator may do to a running mission: a command to all, or a scene change.
using MissionAction = std::variant<CommandKind, SceneChange>;

/// One entry of key `script`.
struct ScriptEvent {
  double at_s = 0.0;                           ///< mission time at which it is due [s]
  MissionAction action = CommandKind::kPause;  ///< what is done then
};

/// A whole mission, as load_mission() reads it.
struct Mission {
  std::string name = "mission";                  ///< 1 to 64 letters, digits, _ - .
  World world;                                   ///< map at the start
  RobotsSpec robots;                             ///< the swarm
  Mixture start;                                 ///< where it starts
  Mixture goal;                                  ///< where it is to be
  std::shared_ptr<const ShapeField> goal_shape;  ///< the drawing `goal` was fitted to; null: none
  PlannerSpec planner;                           ///< planning method and options
  ControlSpec control;                           ///< control method and options
  SafetySpec safety;                             ///< safety filter
  LinkSpec link;                                 ///< communication
  TimingSpec timing;                             ///< timeouts
  PlanClockSpec plan_clock;                      ///< the plan's clock
  LauncherSpec launcher;                         ///< processes
  CriteriaSpec criteria;                         ///< bars of the audit
  std::vector<ScriptEvent> script;               ///< scripted actions, by ascending at_s
};

}  // namespace swarm
