// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/robot/control_registry.hpp"

/// The methods of the papers, as a registry takes them.
namespace swarm::agent {

ControlEntry apf_method();
ControlEntry crops_method();
ControlEntry intermittent_diffusion_method();

struct IntermittentDiffusionOptions;
/// The options of intermittent_diffusion by a mission, for robots with this body.
IntermittentDiffusionOptions intermittent_diffusion_options(const Mission& mission,
                                                            const BodySpec& body);

}  // namespace swarm::agent
