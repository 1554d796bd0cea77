// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/control_registry.hpp"

#include <algorithm>
#include <utility>

#include "robot_agent/methods/builtin_methods.hpp"
#include "swarm_core/base/assert.hpp"

namespace swarm::agent {

/// Methods may share a key only if they agree on its type, range and doc: a mission file has one
/// section for all methods.
void ControlRegistry::add(ControlEntry entry) {
  SWARM_ASSERT(find(entry.spec.name) == nullptr && entry.prepare);
  const auto& own = entry.spec.options;
  SWARM_ASSERT(entry.spec.shape_tolerance.empty() ||
               std::any_of(own.begin(), own.end(), [&](const OptionSpec& o) {
                 return o.key == entry.spec.shape_tolerance && o.kind == OptionSpec::Kind::kNumber;
               }));
  for (const OptionSpec& option : entry.spec.options) {
    for (const ControlEntry& other : entries_) {
      const auto& theirs = other.spec.options;
      SWARM_ASSERT(std::all_of(theirs.begin(), theirs.end(), [&](const OptionSpec& o) {
        return o.key != option.key || o == option;
      }));
    }
  }
  entries_.push_back(std::move(entry));
}

const ControlEntry* ControlRegistry::find(std::string_view name) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const ControlEntry& e) { return e.spec.name == name; });
  return found == entries_.end() ? nullptr : &*found;
}

/// In the order of registration.
Components ControlRegistry::specs() const {
  Components specs;
  for (const ControlEntry& entry : entries_) specs.push_back(entry.spec);
  return specs;
}

void register_builtin_control(ControlRegistry& registry) {
  registry.add(apf_method());
  registry.add(crops_method());
  registry.add(intermittent_diffusion_method());
}

/// Made on first use and never changed afterwards, so all threads may read it.
const ControlRegistry& builtin_control() {
  static const ControlRegistry registry = [] {
    ControlRegistry made;
    register_builtin_control(made);
    return made;
  }();
  return registry;
}

}  // namespace swarm::agent
