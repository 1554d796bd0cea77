// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/papers/table.hpp"

#include "experiments/papers/experiments.hpp"

namespace swarm::launcher {

/// The name was checked by the command line parser, so that the last one needs no test.
Result<ExitCode> make_table(const TableOptions& options) {
  Rows rows(options);
  const Result<void> made = options.which == "swarmprm"         ? swarmprm_experiment(rows)
                            : options.which == "rover"          ? rover_experiment(rows)
                            : options.which == "crops"          ? crops_experiment(rows)
                            : options.which == "diffusion"      ? diffusion_experiment(rows)
                            : options.which == "diffusion_fine" ? fine_diffusion_experiment(rows)
                                                                : network_experiment(rows);
  if (!made) return tl::unexpected(made.error());
  return rows.finish();
}

}  // namespace swarm::launcher
