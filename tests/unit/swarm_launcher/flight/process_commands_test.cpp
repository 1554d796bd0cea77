// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/process_commands.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

namespace swarm::launcher {
namespace {

using Line = std::vector<std::string>;

const std::string kParent = std::to_string(::getpid());

FlightChoices choices() {
  FlightChoices how;
  how.agent_program = "/opt/agent";
  how.planner_program = "/opt/planner";
  return how;
}

Line agent_line(const FlightChoices& how, std::uint32_t process) {
  return agent_command(how, "/run", ProcessIndex(process), RobotId(10), 5).line;
}

TEST(ProcessCommands, StartThePlanner) {
  const ProcessCommand command = planner_command(choices(), "/run");
  EXPECT_EQ(command.line, (Line{"/opt/planner", "--run", "/run", "--parent", kParent}));
  EXPECT_EQ(command.log, "/run/logs/planner.log");
}

TEST(ProcessCommands, StartAgentsWithTheirRobots) {
  const ProcessCommand command = agent_command(choices(), "/run", ProcessIndex(3), RobotId(10), 5);
  EXPECT_EQ(command.line, (Line{"/opt/agent", "--run", "/run", "--ids", "10", "--count", "5",
                                "--number", "2", "--parent", kParent}));
  EXPECT_EQ(command.log, "/run/logs/agent-00010.log");
}

TEST(ProcessCommands, PassSimulatedFaultsToPlannerAndAgents) {
  FlightChoices how = choices();
  how.fault = "loss=0.2";
  for (const Line& line : {planner_command(how, "/run").line, agent_line(how, 1)}) {
    EXPECT_EQ(Line(line.end() - 4, line.end()), (Line{"--fault", "loss=0.2", "--parent", kParent}));
  }
}

TEST(ProcessCommands, GiveAgentsTheirVendor) {
  FlightChoices how = choices();
  how.dds.agents = link::Vendor::kCycloneDds;
  const Line line = agent_line(how, 1);
  EXPECT_EQ(Line(line.end() - 4, line.end()), (Line{"--dds", "cyclonedds", "--parent", kParent}));
}

TEST(ProcessCommands, SendTheFirstAgentsThroughTheGateway) {
  FlightChoices how = choices();
  how.by_gateway = 2;
  const Line line = agent_line(how, 2);
  EXPECT_EQ(Line(line.end() - 5, line.end()),
            (Line{"--dds", "cyclonedds", "--by-gateway", "--parent", kParent}));
  EXPECT_EQ(agent_line(how, 3).size(), line.size() - 3);
}

}  // namespace
}  // namespace swarm::launcher
