// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "experiments/papers/rows.hpp"

/// The experiments behind `swarm_launcher table`, one a file. Each fails if a mission file does.
namespace swarm::launcher {

/// SwarmPRM, Table I: 20 to 500 robots on its map.
Result<void> swarmprm_experiment(Rows& rows);

/// ROVER, Tables I and II, and the histograms of least distances of its Fig. 2.
Result<void> rover_experiment(Rows& rows);

/// CRoPS' maps with 10 to 100 robots; wall time over N.
Result<void> crops_experiment(Rows& rows);

/// Intermittent diffusion's shapes with its N, r and tolerances, beside plain gradient descent.
Result<void> diffusion_experiment(Rows& rows);

/// The same with its smallest and most robots, of 1 cm: an hour.
Result<void> fine_diffusion_experiment(Rows& rows);

/// What loss, delay, noise and clocks out of step do to the SwarmPRM mission: no paper has this.
Result<void> network_experiment(Rows& rows);

}  // namespace swarm::launcher
