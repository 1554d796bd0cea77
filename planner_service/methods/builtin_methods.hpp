// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/planning/planning_registry.hpp"

namespace swarm::planner {

/// Registers the methods of this project: swarmprm, rover, crops, adoc. \pre none of these names is
/// registered
void register_builtin_methods(PlanningRegistry& registry);

}  // namespace swarm::planner
