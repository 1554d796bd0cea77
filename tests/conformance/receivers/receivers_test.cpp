// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Every message of a table must be refused by every program that receives it: counted by reason,
// without a change of state, and the next valid message is used.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/mission/mission_file.hpp"
#include "tests/conformance/receivers/bad_messages.hpp"

namespace swarm::link::conformance {
namespace {

const Mission& mission() {
  static const Mission kMission =
      load_mission(std::string(SWARM_SOURCE_DIR) + "/deploy/missions/small.yaml").value();
  return kMission;
}

struct Program {
  std::string name;
  std::unique_ptr<Receiver> (*make)(const Mission&);
};
const std::vector<Program> kPrograms = {{"Agent", make_agent},
                                        {"Planner", make_planner},
                                        {"Launcher", make_launcher},
                                        {"Monitor", make_monitor},
                                        {"Gateway", make_gateway_receiver}};

/// With one good message of each topic that the program reads.
std::unique_ptr<Receiver> well_informed(const Program& program) {
  auto sut = program.make(mission());
  for (std::size_t topic = 0; topic < std::variant_size_v<AnyMessage>; ++topic) {
    if (sut->reads(good(topic, 1))) sut->publish(good(topic, 1), kNow);
  }
  EXPECT_EQ(sut->refused().total(), 0U);
  return sut;
}

class Receivers : public testing::TestWithParam<Case> {
 protected:
  static bool applies(const Program& program, const Receiver& sut) {
    const Case& c = GetParam();
    return sut.reads(c.bad) && (c.only.empty() || program.name == c.only);
  }
};

TEST_P(Receivers, RefuseItCountItAndGoOn) {
  const Case& c = GetParam();
  int refused_by = 0;
  for (const Program& program : kPrograms) {
    SCOPED_TRACE(program.name);
    const auto sut = well_informed(program);
    if (!applies(program, *sut)) continue;
    const std::string before = sut->state();
    RefusalCounters expected = sut->refused();

    const bool published = sut->publish(c.bad, kNow);

    if (!published) {  // only a foreign encoder makes it: tests/conformance/hostile
      EXPECT_TRUE(program.name == "Monitor" && c.reason == RefusalReason::kOversized);
      continue;
    }
    expected.count(c.reason, 1);
    EXPECT_EQ(sut->refused(), expected) << "counted under another reason, or not once";
    EXPECT_EQ(sut->state(), before);
    ++refused_by;

    sut->publish(good(c.bad.index(), 2), kNow);
    EXPECT_EQ(sut->refused(), expected);
    const bool shown = program.name != "Monitor" || !std::holds_alternative<CommandMessage>(c.bad);
    if (shown) {
      EXPECT_NE(sut->state(), before);
    }
  }
  EXPECT_GT(refused_by, 0);
}

INSTANTIATE_TEST_SUITE_P(Messages, Receivers, testing::ValuesIn(all_cases()),
                         [](const auto& c) { return c.param.name; });

TEST(ReceiversOfTopics, AreTheseFivePrograms) {
  const std::vector<std::string> expected = {"plan Agent Monitor",
                                             "scene Agent Planner Monitor",
                                             "heartbeat Agent Launcher Monitor",
                                             "command Agent Planner Monitor",
                                             "status Planner Launcher Monitor",
                                             "event Launcher Monitor",
                                             "state Agent Monitor Gateway"};
  for (std::size_t topic = 0; topic < expected.size(); ++topic) {
    std::string readers = expected[topic].substr(0, expected[topic].find(' '));
    for (const Program& program : kPrograms) {
      if (program.make(mission())->reads(good(topic, 1))) readers += " " + program.name;
    }
    EXPECT_EQ(readers, expected[topic]);
  }
}

// One forged command near 2^64 must not lock out the launcher's commands after it.
TEST(ReceiversOfCommands, ObeyPauseAndResumeAfterAHugeId) {
  for (const Program& program : kPrograms) {
    SCOPED_TRACE(program.name);
    const auto sut = well_informed(program);
    const bool has_phase = program.name == "Agent" || program.name == "Planner";
    if (!sut->reads(CommandMessage{})) {  // launcher and gateway have no reader of commands at all
      EXPECT_TRUE(program.name == "Launcher" || program.name == "Gateway");
      continue;
    }
    const std::string running = sut->state();
    for (const std::uint64_t huge : {kHuge, kHuge - 1, std::uint64_t{1} << 63}) {
      sut->publish(CommandMessage{.kind = CommandKind::kPause, .command_id = huge}, kNow);
    }
    EXPECT_EQ(sut->refused()[RefusalReason::kForged], 3U);
    EXPECT_EQ(sut->state(), running);

    sut->publish(CommandMessage{.kind = CommandKind::kPause, .command_id = id_after(0)}, kNow);
    if (has_phase) {
      EXPECT_NE(sut->state().find("phase paused"), std::string::npos);
    }
    sut->publish(CommandMessage{.kind = CommandKind::kResume, .command_id = id_after(1)}, kNow);
    EXPECT_EQ(sut->state(), running);
    EXPECT_EQ(sut->refused().total(), 3U);
  }
}

}  // namespace
}  // namespace swarm::link::conformance
