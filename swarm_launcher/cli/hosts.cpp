// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "swarm_core/app/vendor_option.hpp"
#include "swarm_launcher/cli/commands.hpp"
#include "swarm_launcher/cli/shared_options.hpp"
#include "swarm_launcher/flight/gateway.hpp"
#include "swarm_launcher/hosts/join_host.hpp"

namespace swarm::launcher::cli {

// The launcher of the run prints the address to pass here.
Command add_join(CLI::App& program) {
  const auto o = std::make_shared<JoinOptions>();
  CLI::App* const join =
      program.add_subcommand("join", "Start robots of a run whose launcher is on another host");
  join->add_option("launcher", o->launcher, "Address of that launcher, as it prints it")
      ->required()
      ->type_name("HOST:PORT");
  join->add_option("--robots", o->robots,
                   "Number of robots to start, if as many are left (default: 1)")
      ->check(CLI::Range(1, kMostRobots));
  add_join_token(*join, o->token);
  join->add_option(
          "--interface", o->interface,
          "IPv4 address of the interface to use (default: the one that reaches the launcher)")
      ->check(CLI::ValidIPV4);
  shell::add_vendor_option(*join, o->dds, "DDS vendor of the agents");
  join->add_option("--out", o->out, "Run directory (default: runs/joined-<time>)");
  return {join, [o] { return join_host(*o); }};
}

// Started by the launcher for --by-gateway, or by hand for a run in progress.
Command add_gateway(CLI::App& program) {
  const auto o = std::make_shared<GatewayCommandOptions>();
  CLI::App* const gateway = program.add_subcommand(
      "gateway", "Carry robot states between the multicast groups of a run and DDS topics");
  gateway->add_option("run", o->run_dir, "Run directory")->required()->type_name("RUN_DIR");
  gateway->add_option("--parent", o->parent_pid, "End when this process is no longer the parent");
  return {gateway, [o] { return run_gateway(*o); }};
}

}  // namespace swarm::launcher::cli
