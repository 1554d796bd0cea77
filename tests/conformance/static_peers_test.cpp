// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A run without a discovery server: launcher and planner at known ports, agents that know them
// only.
#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>

#include <gtest/gtest.h>

#include "swarm_link/roles/join.hpp"
#include "tests/conformance/bus.hpp"
#include "tests/conformance/samples.hpp"

namespace swarm::link::conformance {
namespace {

constexpr std::uint32_t kAgents = 4;

struct AgentSeat {
  std::unique_ptr<Participant> participant;
  ReaderPtr<PlanMessage> plans;
  ReaderPtr<CommandMessage> commands;
  WriterPtr<StatusMessage> status;
  std::vector<PlanMessage> received_plans;
  std::vector<CommandMessage> received_commands;
};

/// Who speaks whose DDS. A process has one configuration of Cyclone's, so that a planner and agents
/// of its are for the system tests.
struct Vendors {
  Vendor agents;
  Vendor planner;
};

struct StaticPeersRun : testing::TestWithParam<Vendors> {
  StaticPeersRun() {
    statuses = launcher->make_reader(status_topic()).value();
    commands = launcher->make_writer(command_topic()).value();
    start_planner();
    for (std::uint32_t i = 0; i < kAgents; ++i) {
      AgentSeat& agent = agents.emplace_back();
      agent.participant = join_as_agent(meeting, i, "agent", GetParam().agents).value();
      agent.plans = agent.participant->make_reader(plan_topic()).value();
      agent.commands = agent.participant->make_reader(command_topic()).value();
      agent.status = agent.participant->make_writer(status_topic()).value();
    }
  }

  void start_planner() {
    planner = join_as_planner(meeting).value();
    plans = planner->make_writer(plan_topic()).value();
    planner_commands = planner->make_reader(command_topic()).value();
    planner_sees = planner->make_reader(status_topic_unacknowledged()).value();
  }

  void kill_planner() {  // as far as a process can do that to itself: nothing is published any more
    planner_sees.reset();
    planner_commands.reset();
    plans.reset();
    planner.reset();
  }

  bool eventually(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (std::chrono::steady_clock::now() < deadline) {
      launcher->receive();
      if (planner) planner->receive();
      statuses->take(received_statuses);
      if (planner) planner_commands->take(planner_received);
      if (planner) planner_sees->take(seen_statuses);
      for (AgentSeat& agent : agents) {
        agent.participant->receive();
        agent.plans->take(agent.received_plans);
        agent.commands->take(agent.received_commands);
      }
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }

  bool all_have_plan(std::uint32_t version) {
    return eventually([&] {
      return std::all_of(agents.begin(), agents.end(), [&](const AgentSeat& agent) {
        return !agent.received_plans.empty() && agent.received_plans.back().version == version;
      });
    });
  }

  Meeting meeting{.domain = test_domain(), .relays = 2, .planner = GetParam().planner};
  std::unique_ptr<Participant> launcher = join_as_launcher(meeting).value();
  std::unique_ptr<Participant> planner;
  ReaderPtr<StatusMessage> statuses;
  WriterPtr<CommandMessage> commands;
  WriterPtr<PlanMessage> plans;
  ReaderPtr<CommandMessage> planner_commands;
  ReaderPtr<StatusMessage> planner_sees;
  std::vector<AgentSeat> agents;
  std::vector<StatusMessage> received_statuses;
  std::vector<StatusMessage> seen_statuses;
  std::vector<CommandMessage> planner_received;
};

INSTANTIATE_TEST_SUITE_P(Vendors, StaticPeersRun,
                         testing::Values(Vendors{Vendor::kFastDds, Vendor::kFastDds},
                                         Vendors{Vendor::kCycloneDds, Vendor::kFastDds},
                                         Vendors{Vendor::kFastDds, Vendor::kCycloneDds}),
                         [](const auto& vendors) {
                           const bool fast_agents = vendors.param.agents == Vendor::kFastDds;
                           const bool fast_planner = vendors.param.planner == Vendor::kFastDds;
                           return std::string(fast_agents ? "FastAgents" : "CycloneAgents") +
                                  (fast_planner ? "FastPlanner" : "CyclonePlanner");
                         });

TEST_P(StaticPeersRun, EveryAgentReceivesPlannerAndLauncherOnly) {
  Rng rng(1);
  PlanMessage plan = plan_of_size(rng, 2000, 4000);  // 160 kB
  plan.version = 1;
  plans->write(plan);
  commands->write({.command_id = 5});

  EXPECT_TRUE(all_have_plan(1));
  EXPECT_TRUE(eventually([&] {
    return !planner_received.empty() &&
           std::all_of(agents.begin(), agents.end(),
                       [](const AgentSeat& agent) { return !agent.received_commands.empty(); });
  }));
  for (AgentSeat& agent : agents) {
    EXPECT_EQ(agent.received_plans.back(), plan);
    EXPECT_EQ(agent.plans->matched(), 1);
    EXPECT_EQ(agent.commands->matched(), 1);
    EXPECT_EQ(agent.status->matched(), 2);  // launcher and planner
  }
  EXPECT_EQ(commands->matched(), static_cast<int>(kAgents) + 1);
}

TEST_P(StaticPeersRun, LauncherAndPlannerReceiveEveryAgent) {
  // Volatile: what is published before both sides have found each other is lost.
  ASSERT_TRUE(eventually([&] {
    return statuses->matched() == static_cast<int>(kAgents) &&
           planner_sees->matched() == static_cast<int>(kAgents) &&
           std::all_of(agents.begin(), agents.end(),
                       [](const AgentSeat& agent) { return agent.status->matched() == 2; });
  }));
  for (std::uint32_t i = 0; i < kAgents; ++i) agents[i].status->write({.first_robot_id = i});

  EXPECT_TRUE(eventually([&] { return received_statuses.size() == kAgents; }));
  EXPECT_TRUE(eventually([&] { return seen_statuses.size() == kAgents; }));
}

TEST_P(StaticPeersRun, AgentsFindARestartedPlanner) {
  plans->write({.version = 1});
  commands->write({.command_id = 5});
  ASSERT_TRUE(all_have_plan(1));
  kill_planner();
  planner_received.clear();
  start_planner();
  plans->write({.version = 2});

  EXPECT_TRUE(all_have_plan(2));
  EXPECT_TRUE(eventually([&] { return !planner_received.empty(); }));  // the command it missed
}

TEST(StaticPeers, RefusesARelayWhosePortIsTaken) {
  const Meeting meeting{.domain = test_domain(), .relays = 2};
  const auto first = join_as_planner(meeting);
  ASSERT_TRUE(first) << first.error().message;

  const auto second = join_as_planner(meeting);

  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kEnvironment);
  EXPECT_NE(second.error().message.find("taken"), std::string::npos) << second.error().message;
}

}  // namespace
}  // namespace swarm::link::conformance
