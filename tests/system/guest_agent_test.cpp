// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Missions flown by a robot program that is not ours: guest/guest_agent.cpp.
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program.hpp"

namespace swarm::test {
namespace {

constexpr const char* kGuest = SWARM_BIN_DIR "/guest_agent";

std::string mission(const std::string& control) {
  return fmt::format(R"(version: 1
name: guest
world: {{bounds_m: [0, 0, 40, 30]}}
robots: {{count: 6}}
start: [{{mean_m: [8, 15], covariance_m2: [[4, 0], [0, 4]], weight: 1}}]
goal: [{{mean_m: [24, 15], covariance_m2: [[4, 0], [0, 4]], weight: 1}}]
control: {{{}}}
launcher: {{time_limit_s: 40}}
)",
                     control);
}

class GuestAgent : public ::testing::Test {
 protected:
  /// Flies to the end; the summary.
  nlohmann::json fly(const std::string& control) {
    std::ofstream(folder_.path() / "mission.yaml") << mission(control);
    Program run("swarm_launcher",
                {"run", (folder_.path() / "mission.yaml").string(), "--agent-program", kGuest,
                 "--out", run_dir().string(), "--json"});
    run.wait();
    error_ = run.err();
    return nlohmann::json::parse(run.out(), nullptr, false);
  }
  std::filesystem::path run_dir() const { return folder_.path() / "run"; }
  std::string events() const { return read_text(run_dir() / "events.jsonl"); }

  TemporaryFolder folder_;
  std::string error_;
};

TEST_F(GuestAgent, HasItsKeysCheckedWithLineAndColumn) {
  const auto summary = fly("method: faulty, fault: sometimes, falt: nan");

  EXPECT_TRUE(summary.is_discarded());
  EXPECT_NE(error_.find("mission.yaml:7:34: control.fault is \"sometimes\"; must be one of: throw, "
                        "nan, sleep"),
            std::string::npos)
      << error_;
  EXPECT_NE(error_.find("unknown key control.falt; did you mean control.fault?"), std::string::npos)
      << error_;
}

TEST_F(GuestAgent, StopsARobotAloneWhoseControlMethodThrows) {
  const auto summary = fly("method: faulty, fault: throw");

  ASSERT_FALSE(summary.is_discarded()) << error_;
  EXPECT_EQ(summary["arrived"], 5);
  EXPECT_NE(summary["outcome"], "time_limit") << "the others do not wait for it";
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_NE(events().find("robot 3: the control method threw: no compass"), std::string::npos)
      << events();
}

TEST_F(GuestAgent, StopsARobotAloneWhoseControlMethodReturnsNaN) {
  const auto summary = fly("method: faulty, fault: nan");

  ASSERT_FALSE(summary.is_discarded()) << error_;
  EXPECT_EQ(summary["arrived"], 5);
  EXPECT_NE(summary["outcome"], "time_limit") << "the others do not wait for it";
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_NE(events().find("robot 3: the control method returned a velocity that is not finite"),
            std::string::npos)
      << events();
}

TEST_F(GuestAgent, ReportsATickThatOutlivesItsCommandAndFliesOn) {
  const auto summary = fly("method: faulty, fault: sleep");

  ASSERT_FALSE(summary.is_discarded()) << error_;
  EXPECT_EQ(summary["arrived"], 6);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_TRUE(has_event(run_dir(), "tick-overrun")) << events();
}

TEST(AgentProgram, ThatIsNoneIsRefused) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "mission.yaml") << mission("method: apf");
  Program run("swarm_launcher",
              {"run", (folder.path() / "mission.yaml").string(), "--agent-program", "/bin/ls"});

  EXPECT_EQ(run.wait(), 3);
  EXPECT_NE(run.err().find("/bin/ls --describe"), std::string::npos) << run.err();
}

}  // namespace
}  // namespace swarm::test
