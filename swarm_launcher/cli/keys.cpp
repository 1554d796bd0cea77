// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <memory>

#include "swarm_core/mission_file/mission_keys.hpp"
#include "swarm_launcher/cli/commands.hpp"
#include "swarm_launcher/processes/described_program.hpp"

namespace swarm::launcher::cli {

// The components of other programs have keys of their own, which --describe reports.
Command add_keys(CLI::App& program) {
  const auto agent_program = std::make_shared<std::filesystem::path>();
  CLI::App* const keys = program.add_subcommand(
      "keys", "Print all keys of a mission file with their ranges and defaults, as Markdown");
  keys->add_option("--agent-program", *agent_program,
                   "Robot program whose components are printed instead of the built-in ones");
  const auto planner_program = std::make_shared<std::filesystem::path>();
  keys->add_option("--planner-program", *planner_program,
                   "Planner program whose methods are printed instead of the built-in ones");
  return {keys, [agent_program, planner_program]() -> Result<ExitCode> {
            const auto catalogue = catalogue_of(*agent_program, *planner_program);
            if (!catalogue) return tl::unexpected(catalogue.error());
            std::fputs(mission_keys_markdown(*catalogue).c_str(), stdout);
            return ExitCode::kOk;
          }};
}

}  // namespace swarm::launcher::cli
