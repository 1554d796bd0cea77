// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "experiments/papers/rows.hpp"

/// The experiments behind `swarm_launcher table`, one per source file. Each fails if a mission file
/// cannot be read.
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

/// The SwarmPRM mission under loss, delay, noise and clocks out of step; without a published
/// counterpart.
Result<void> network_experiment(Rows& rows);

}  // namespace swarm::launcher
