// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_membership.hpp"

#include <csignal>
#include <optional>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::shell {
namespace {

TEST(RunMembership, IsRefusedOnceTheRunHasItsSummary) {
  const ScratchFolder run;
  EXPECT_TRUE(check_run_goes_on(run.path()));
  run.write("summary.json", "{}");
  const auto refused = check_run_goes_on(run.path());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadInput);
  EXPECT_NE(refused.error().message.find("this run has ended"), std::string::npos);
  EXPECT_NE(refused.error().message.find("swarm_launcher run"), std::string::npos);
}

TEST(RobotLock, IsOfOneHolderPerRobot) {
  const ScratchFolder run;
  auto first = RobotLock::take(run.path(), RobotId(3), 4);
  ASSERT_TRUE(first);
  const struct {
    std::uint32_t first, count;
    bool free;
  } cases[] = {{3, 1, false}, {6, 1, false}, {0, 4, false}, {0, 100, false},
               {4, 2, false}, {0, 3, true},  {7, 1, true},  {7, 100, true}};
  for (const auto& c : cases) {
    EXPECT_EQ(RobotLock::take(run.path(), RobotId(c.first), c.count).has_value(), c.free)
        << c.first << " and " << c.count;
  }
}

TEST(RobotLock, NamesTheRobotThatIsTaken) {
  const ScratchFolder run;
  const auto first = RobotLock::take(run.path(), RobotId(5), 2);
  const auto second = RobotLock::take(run.path(), RobotId(4), 2);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kBadInput);
  EXPECT_NE(second.error().message.find("another process moves robot 5"), std::string::npos)
      << second.error().message;
}

TEST(RobotLock, EndsWithItsHolder) {
  const ScratchFolder run;
  std::optional<RobotLock> kept;
  {
    auto first = RobotLock::take(run.path(), RobotId(3), 1);
    kept.emplace(*std::move(first));
  }
  EXPECT_FALSE(RobotLock::take(run.path(), RobotId(3), 1)) << "moved, not released";
  kept.reset();
  EXPECT_TRUE(RobotLock::take(run.path(), RobotId(3), 1));
}

TEST(RobotLock, EndsWithAProcessThatIsKilled) {
  const ScratchFolder run;
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto lock = RobotLock::take(run.path(), RobotId(3), 1);
    [[maybe_unused]] const auto wrote = ::write(ready[1], lock ? "y" : "n", 1);
    for (;;) ::pause();
  }
  char answer = 0;
  ASSERT_EQ(::read(ready[0], &answer, 1), 1);
  EXPECT_EQ(answer, 'y');
  EXPECT_FALSE(RobotLock::take(run.path(), RobotId(3), 1));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(RobotLock::take(run.path(), RobotId(3), 1));
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST(RobotLock, DoesNotKeepRobotsFromFlyingWithoutADisk) {
  EXPECT_TRUE(RobotLock::take("/nonexistent/run", RobotId(3), 1));
}

}  // namespace
}  // namespace swarm::shell
