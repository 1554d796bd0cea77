// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "swarm_core/shell/program.hpp"
#include "swarm_core/shell/stop_signal.hpp"
#include "swarm_launcher/command.hpp"
#include "swarm_launcher/gateway.hpp"
#include "swarm_launcher/hosts/join_host.hpp"
#include "swarm_launcher/plan.hpp"
#include "swarm_launcher/run.hpp"
#include "swarm_launcher/simulation/simulate.hpp"
#include "swarm_launcher/soak/soak.hpp"
#include "swarm_launcher/table/table.hpp"

int main(int argc, char** argv) {
  using namespace swarm;
  return shell::run_main("swarm_launcher", [&]() -> Result<ExitCode> {
    CLI::App app(
        "Flies a swarm: starts planner and robots, scripts the mission, supervises, reports.\n"
        "  swarm_launcher run deploy/missions/swarmprm_standin.yaml\n"
        "  swarm_launcher command RUN_DIR stop",
        "swarm_launcher");
    app.require_subcommand(1);
    shell::add_common_options(app);

    launcher::RunOptions run;
    CLI::App* run_command = app.add_subcommand("run", "Fly a mission with one process per robot");
    run_command->add_option("mission", run.mission_file, "Mission file")
        ->required()
        ->type_name("MISSION.yaml");
    run_command->add_option("--robots", run.robots, "Number of robots, instead of the mission's")
        ->check(CLI::Range(1, 20000));
    auto* per_process =
        run_command
            ->add_option("--per-process", run.per_process, "Robots hosted by one agent process")
            ->check(CLI::Range(1, 20000));
    std::string processes;
    run_command
        ->add_option(
            "--processes", processes,
            "Agent processes, or auto: one a robot while the machine carries that, else few")
        ->check(CLI::IsMember({"auto"}) | CLI::Range(1, 20000))
        ->type_name("N|auto")
        ->excludes(per_process);
    run_command->add_option("--seed", run.seed, "Seed of placement, plan and robots");
    run_command->add_option("--out", run.out, "Run directory (default: runs/<mission>-<time>)");
    run_command->add_option("--domain", run.domain, "DDS domain (default: a free one)")
        ->check(CLI::Range(0, 229));
    const std::map<std::string, std::optional<Channel>> channels = {
        {"auto", std::nullopt}, {"topics", Channel::kTopics}, {"groups", Channel::kGroups}};
    std::string channel = "auto";
    run_command
        ->add_option("--channel", channel,
                     "What carries robot states: DDS topics, multicast groups, or auto")
        ->check(CLI::IsMember(channels));
    const std::map<std::string, launcher::AgentDds> agent_dds = {
        {"fastdds", launcher::AgentDds::kFastDds},
        {"cyclonedds", launcher::AgentDds::kCycloneDds},
        {"half", launcher::AgentDds::kHalf}};
    run_command
        ->add_option("--agent-dds", run.agent_dds, "Whose DDS the agents speak (groups channel)")
        ->transform(CLI::CheckedTransformer(agent_dds));
    run_command->add_option(
        "--by-gateway", run.by_gateway,
        "The first N agent processes speak Cyclone DDS and say their states by\n"
        "topics, through a gateway to the others' groups");
    std::string planner_dds = "fastdds";
    run_command
        ->add_option("--planner-dds", planner_dds, "Whose DDS the planner speaks (groups channel)")
        ->check(CLI::IsMember({"fastdds", "cyclonedds"}));
    run_command
        ->add_option("--fault", run.fault,
                     "A bad network for what planner and robots receive, like\n"
                     "loss=0.2,delay-ms=150,jitter-ms=50,from=10,to=60")
        ->type_name("FAULT");
    run_command->add_option("--interface", run.interface, "IPv4 address to meet other hosts on")
        ->check(CLI::ValidIPV4);
    run_command->add_option("--remote", run.remote,
                            "Robots, the last ones, that other hosts start: see join");
    run_command->add_option("--join-port", run.join_port,
                            "TCP port where those come to (default: a free one)");
    run_command->add_flag("--json", run.json, "Print the summary as JSON");

    launcher::GatewayCommandOptions gateway;
    CLI::App* gateway_command = app.add_subcommand(
        "gateway", "Carry the robot states of a run between groups and DDS topics");
    gateway_command->add_option("run", gateway.run_dir, "Run directory")
        ->required()
        ->type_name("RUN_DIR");
    gateway_command->add_option("--parent", gateway.parent_pid,
                                "End when this process is no longer our parent");

    launcher::JoinOptions join;
    CLI::App* join_command =
        app.add_subcommand("join", "Fly robots of a run that another host's launcher leads");
    join_command->add_option("launcher", join.launcher, "As that launcher says it")
        ->required()
        ->type_name("HOST:PORT");
    join_command->add_option("--robots", join.robots, "So many, if there are as many left")
        ->check(CLI::Range(1, 20000));
    join_command
        ->add_option("--interface", join.interface,
                     "IPv4 address to meet them on (default: of the way to the launcher)")
        ->check(CLI::ValidIPV4);
    join_command->add_flag("--cyclonedds", join.cyclone, "The agents speak Cyclone DDS");
    join_command->add_option("--out", join.out, "Run directory (default: runs/joined-<time>)");

    launcher::SoakOptions soak;
    std::string soak_channel = "auto";
    CLI::App* soak_command = app.add_subcommand(
        "soak", "Keep a swarm moving, and measure what its link and its processes do");
    soak_command->add_option("--processes", soak.processes, "Number of agent processes")
        ->check(CLI::Range(1, 20000));
    soak_command->add_option("--per-process", soak.per_process, "Robots hosted by each")
        ->check(CLI::Range(1, 20000));
    soak_command->add_option("--rate-hz", soak.rate_hz, "Control rate")
        ->check(CLI::Range(1.0, 100.0));
    soak_command->add_option("--duration-s", soak.duration_s, "How long robots move")
        ->check(CLI::Range(5.0, 1e6));
    soak_command->add_option("--channel", soak_channel, "As for run")
        ->check(CLI::IsMember(channels));
    soak_command->add_option("--fault", soak.fault, "A bad network, as for run")
        ->type_name("FAULT");
    soak_command->add_option("--max-p99-ms", soak.criteria.max_p99_ms,
                             "Fail if 1 % of states take longer to a listener");
    soak_command->add_option("--max-loss", soak.criteria.max_loss,
                             "Fail if a larger share of states is lost");
    soak_command->add_option("--max-rss-growth-pct", soak.criteria.max_rss_growth_pct,
                             "Fail if the agents' memory grows by more");
    soak_command->add_option("--seed", soak.seed, "Seed of placement, plan and robots");
    soak_command->add_option("--out", soak.out, "Run directory (default: runs/soak-<time>)");
    soak_command->add_option("--domain", soak.domain, "DDS domain (default: a free one)")
        ->check(CLI::Range(0, 229));
    soak_command->add_flag("--json", soak.json, "Print the result as JSON");

    launcher::PlanCommandOptions plan;
    CLI::App* plan_command = app.add_subcommand("plan", "Plan a mission without flying it");
    plan_command->add_option("mission", plan.mission_file, "Mission file")
        ->required()
        ->type_name("MISSION.yaml");
    plan_command->add_option("--seed", plan.seed, "First seed");
    plan_command->add_option("--repeat", plan.repeat, "Number of seeds")
        ->check(CLI::Range(1, 100000));
    plan_command->add_option("--out", plan.out, "Directory for plan.json and plan.svg");
    plan_command->add_flag("--json", plan.json, "Print the result as JSON");

    launcher::SimulateOptions simulate;
    std::string simulated_fault;
    bool clocks_apart = false;
    bool no_record = false;
    CLI::App* simulate_command = app.add_subcommand(
        "simulate", "Fly a mission in lock-step, in one process, as fast as it goes");
    simulate_command->add_option("mission", simulate.mission_file, "Mission file")
        ->required()
        ->type_name("MISSION.yaml");
    simulate_command
        ->add_option("--robots", simulate.robots, "Number of robots, instead of the mission's")
        ->check(CLI::Range(1, 200000));
    simulate_command->add_option("--seed", simulate.seed,
                                 "Seed of placement, plan, robots, faults");
    simulate_command->add_option("--fault", simulated_fault, "A bad network, as for run")
        ->type_name("FAULT");
    simulate_command->add_flag("--clocks-apart", clocks_apart,
                               "Robots tick at different moments of the control period");
    simulate_command->add_option("--threads", simulate.threads, "0: as many as make it faster")
        ->check(CLI::Range(0, 256));
    simulate_command->add_flag("--no-record", no_record,
                               "No black boxes, audit and report: arrivals and times alone");
    simulate_command->add_option("--out", simulate.out,
                                 "Run directory (default: runs/<mission>-<time>)");
    simulate_command->add_flag("--json", simulate.json, "Print the summary as JSON");

    launcher::TableOptions table;
    CLI::App* table_command = app.add_subcommand(
        "table", "Simulate a paper's experiment: its table, its peers and ours side by side");
    table_command->add_option("which", table.which, "swarmprm, rover, crops, diffusion or network")
        ->required()
        ->check(CLI::IsMember({"swarmprm", "rover", "crops", "diffusion", "network"}));
    table_command->add_flag("--quick", table.quick, "Fewer robots and seeds");
    table_command->add_option("--missions", table.missions, "Where the mission files are");
    table_command->add_option("--out", table.out, "Directory for Markdown, JSON and pictures");

    std::filesystem::path run_dir;
    std::vector<std::string> words;
    CLI::App* command = app.add_subcommand(
        "command",
        "Command a running mission: start, pause, resume, stop (an emergency stop), or a change:\n"
        "  add_obstacle 'circle_m: {center: [100, 60], radius: 4}'    (or polygon_m: [[x, y], "
        "...])\n"
        "  move_obstacle 'obstacle: 6, by_m: [10, 0], over_s: 20'\n"
        "  remove_obstacle 'obstacle: 6'\n"
        "  goto 'goal: [{mean_m: [20, 20], covariance_m2: [[9, 0], [0, 9]], weight: 1}]'\n"
        "  risk 'alpha: 0.15'");
    command->add_option("run_dir", run_dir, "Its run directory")->required()->type_name("RUN_DIR");
    command->add_option("words", words, "The command and its keys, as in a script")
        ->required()
        ->type_name("WORD [KEYS]");

    const auto done = shell::parse(app, argc, argv);
    if (!done) return tl::unexpected(done.error());
    if (*done) return **done;
    shell::catch_stop_signals();
    run.channel = channels.at(channel);
    if (!processes.empty()) {
      run.processes = processes == "auto" ? 0U : static_cast<std::uint32_t>(std::stoul(processes));
    }
    run.cyclone_planner = planner_dds == "cyclonedds";
    if (run_command->parsed()) return launcher::run_mission(run);
    soak.channel = channels.at(soak_channel);
    if (soak_command->parsed()) return launcher::soak(soak);
    if (gateway_command->parsed()) return launcher::run_gateway(gateway);
    if (join_command->parsed()) return launcher::join_host(join);
    if (plan_command->parsed()) return launcher::plan_mission(plan);
    const auto faults = parse_link_faults(simulated_fault);
    if (!faults) return tl::unexpected(faults.error());
    simulate.faults = *faults;
    simulate.clocks_in_step = !clocks_apart;
    simulate.record = !no_record;
    if (simulate_command->parsed()) return launcher::simulate_mission(simulate);
    if (table_command->parsed()) return launcher::make_table(table);
    return launcher::command_mission(run_dir, fmt::format("{}", fmt::join(words, " ")));
  });
}
