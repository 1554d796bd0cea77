// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/process_commands.hpp"

#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_launcher/processes/child_process.hpp"

namespace swarm::launcher {
namespace {

// Adds the options that planner and agents have in common.
ProcessCommand complete(std::vector<std::string> line, const FlightChoices& how,
                        const std::filesystem::path& dir, const std::string& log) {
  if (!how.fault.empty()) line.insert(line.end(), {"--fault", how.fault});
  line.insert(line.end(), {"--parent", fmt::format("{}", ::getpid())});
  return {.line = std::move(line), .log = dir / shell::kLogsFolder / log};
}

}  // namespace

ProcessCommand planner_command(const FlightChoices& how, const std::filesystem::path& dir) {
  return complete({program_or(how.planner_program, "planner_service"), "--run", dir.string()}, how,
                  dir, "planner.log");
}

ProcessCommand agent_command(const FlightChoices& how, const std::filesystem::path& dir,
                             ProcessIndex process, RobotId first, std::uint32_t count) {
  std::vector<std::string> line = {program_or(how.agent_program, "robot_agent"),
                                   "--run",
                                   dir.string(),
                                   "--ids",
                                   fmt::format("{}", first.value()),
                                   "--count",
                                   fmt::format("{}", count),
                                   "--number",
                                   fmt::format("{}", process.value() - 1)};
  const bool by_gateway = process.value() <= how.by_gateway;
  const link::Vendor vendor = by_gateway ? link::Vendor::kCycloneDds : how.dds.agents;
  if (vendor != link::Vendor::kFastDds) {
    line.insert(line.end(), {"--dds", std::string(to_string(vendor))});
  }
  if (by_gateway) line.emplace_back("--by-gateway");
  return complete(std::move(line), how, dir, fmt::format("agent-{:05}.log", first.value()));
}

}  // namespace swarm::launcher
