// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/driver_registry.hpp"

#include <algorithm>
#include <utility>

#include "robot_agent/drivers/simulated_robot.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::agent {
namespace {

/// An entry for a motion model of the simulated robot; make_simulated_body() picks the model by the
/// name in the mission.
DriverEntry simulated(std::string name, std::string doc, const LagSpec& lag) {
  return {.spec = {.name = std::move(name), .doc = std::move(doc), .options = {}, .lag = lag},
          .make = [](const DriverContext& context) -> Result<std::unique_ptr<Driver>> {
            return std::make_unique<SimulatedRobot>(
                make_simulated_body(context.body(), context.now, context.position_m, context.seed));
          }};
}

}  // namespace

void DriverRegistry::add(DriverEntry entry) {
  SWARM_ASSERT(find(entry.spec.name) == nullptr && entry.make);
  entries_.push_back(std::move(entry));
}

const DriverEntry* DriverRegistry::find(std::string_view name) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const DriverEntry& e) { return e.spec.name == name; });
  return found == entries_.end() ? nullptr : &*found;
}

Components DriverRegistry::specs() const {
  Components specs;
  for (const DriverEntry& entry : entries_) specs.push_back(entry.spec);
  return specs;
}

/// All built-in drivers are simulated. The lag declares which limits a body must have, for the
/// safety filter.
void register_builtin_drivers(DriverRegistry& registry) {
  registry.add(simulated("single_integrator", "Simulated: has a commanded velocity at once", {}));
  registry.add(simulated("unicycle", "Simulated: drives forwards and turns, within limits",
                         {.accelerates = true, .turns = true}));
  registry.add(simulated("double_integrator", "Simulated: accelerates within a limit",
                         {.accelerates = true}));
}

}  // namespace swarm::agent
