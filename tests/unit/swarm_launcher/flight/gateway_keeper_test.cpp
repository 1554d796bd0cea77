// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/gateway_keeper.hpp"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct GatewayKeeperTest : testing::Test {
  pid_t pid = 0;  ///< of the last process that was started
  int starts = 0;
  std::vector<pid_t> ended;
  std::vector<pid_t> killed;
  std::optional<std::uint32_t> beat;  ///< since the last step
  std::string start_error;            ///< why none can be started
  SteadyTime now{seconds(1000)};
  std::optional<GatewayKeeper> sut{
      std::in_place,
      GatewayKeeper::Means{.start = [this]() -> Result<pid_t> {
                             ++starts;
                             if (!start_error.empty()) {
                               return fail(ErrorCode::kEnvironment, start_error);
                             }
                             return pid = 100 + starts;
                           },
                           .end = [this](pid_t child) { ended.push_back(child); },
                           .kill = [this](pid_t child) { killed.push_back(child); },
                           .beat = [this](pid_t) { return std::exchange(beat, std::nullopt); }}};

  std::optional<LogEvent> step_with_beat(SteadyTime at, std::uint32_t robots = 0) {
    beat = robots;
    return sut->step(at);
  }
};

TEST_F(GatewayKeeperTest, IgnoresOtherChildren) {
  ASSERT_TRUE(sut->start(now));
  EXPECT_FALSE(sut->on_exit(7, now));
  EXPECT_FALSE(sut->step(now + GatewayKeeper::kFirstBeat));
  EXPECT_EQ(starts, 1);
}

TEST_F(GatewayKeeperTest, ReportsItsEndAndItsRestart) {
  ASSERT_TRUE(sut->start(now));
  const auto exit = sut->on_exit(pid, now);
  ASSERT_TRUE(exit);
  EXPECT_TRUE(exit->warning);
  EXPECT_EQ(exit->code, "gateway-exit");
  EXPECT_FALSE(sut->step(now + milliseconds(299)));
  const auto restart = sut->step(now + milliseconds(300));
  ASSERT_TRUE(restart);
  EXPECT_EQ(restart->code, "gateway-restarted");
  EXPECT_EQ(starts, 2);
  EXPECT_FALSE(sut->step(now + seconds(10))) << "it runs";
}

TEST_F(GatewayKeeperTest, RestartsOneThatKeepsCrashingEverMoreSlowlyAndWithoutEnd) {
  ASSERT_TRUE(sut->start(now));
  for (int deaths = 1; deaths <= 20; ++deaths) {
    ASSERT_TRUE(sut->on_exit(pid, now));
    const Duration delay = from_seconds(std::min(30.0, 0.3 * std::pow(2.0, deaths - 1)));
    ASSERT_FALSE(sut->step(now + delay - milliseconds(1))) << deaths;
    now += delay;
    ASSERT_TRUE(sut->step(now)) << deaths;
  }
  now += seconds(60);
  sut->on_exit(pid, now);
  EXPECT_TRUE(sut->step(now + milliseconds(300))) << "it was well";
}

TEST_F(GatewayKeeperTest, TriesAgainWhenItCannotBeStarted) {
  ASSERT_TRUE(sut->start(now));
  sut->on_exit(pid, now);
  start_error = "no process left";
  const auto failed = sut->step(now + milliseconds(300));
  ASSERT_TRUE(failed);
  EXPECT_EQ(failed->code, "gateway-exit");
  EXPECT_NE(failed->text.find("no process left"), std::string::npos);
  EXPECT_FALSE(sut->on_exit(pid, now + milliseconds(300))) << "there is no process";
  start_error.clear();
  EXPECT_FALSE(sut->step(now + milliseconds(800)));
  EXPECT_EQ(sut->step(now + milliseconds(900))->code, "gateway-restarted");
}

// It is matched with the robots some seconds after its first beat.
TEST_F(GatewayKeeperTest, ReceivesTheRobotsOfItsLastBeatUntilItEnds) {
  ASSERT_TRUE(sut->start(now));
  sut->step(now + seconds(20));
  EXPECT_EQ(sut->robots_received(), 0U);
  step_with_beat(now + seconds(20), 3);
  sut->step(now + seconds(21));
  EXPECT_EQ(sut->robots_received(), 3U);
  step_with_beat(now + seconds(22), 5);
  EXPECT_EQ(sut->robots_received(), 5U);

  sut->on_exit(pid, now + seconds(23));
  EXPECT_EQ(sut->robots_received(), 0U);
  ASSERT_TRUE(sut->step(now + seconds(24)));
  step_with_beat(now + seconds(25), 0);
  EXPECT_EQ(sut->robots_received(), 0U) << "it is not matched yet";
}

TEST_F(GatewayKeeperTest, KillsOneThatHangsOnceAndStartsItAgain) {
  ASSERT_TRUE(sut->start(now));
  step_with_beat(now, 4);
  EXPECT_FALSE(sut->step(now + GatewayKeeper::kSilence));
  now += GatewayKeeper::kSilence + milliseconds(1);
  const auto silent = sut->step(now);
  ASSERT_TRUE(silent);
  EXPECT_EQ(silent->code, "gateway-silent");
  EXPECT_EQ(sut->robots_received(), 0U);
  EXPECT_FALSE(sut->step(now + seconds(5))) << "once";
  EXPECT_EQ(killed, std::vector{pid});

  now += seconds(5);
  ASSERT_TRUE(sut->on_exit(pid, now));
  ASSERT_TRUE(sut->step(now + milliseconds(300)));
  EXPECT_EQ(starts, 2);
}

TEST_F(GatewayKeeperTest, WaitsLongerForTheFirstBeat) {
  ASSERT_TRUE(sut->start(now));
  EXPECT_FALSE(sut->step(now + GatewayKeeper::kFirstBeat));
  EXPECT_TRUE(sut->step(now + GatewayKeeper::kFirstBeat + milliseconds(1)));
  EXPECT_EQ(killed, std::vector{pid});
}

// Its beats of that time wait in the socket.
TEST_F(GatewayKeeperTest, KillsNoneAfterTheLauncherWasSuspended) {
  ASSERT_TRUE(sut->start(now));
  step_with_beat(now);
  EXPECT_FALSE(step_with_beat(now + seconds(20)));
  EXPECT_TRUE(killed.empty());
}

TEST_F(GatewayKeeperTest, FailsAtTheFirstStart) {
  start_error = "no process left";
  EXPECT_FALSE(sut->start(now));
  sut.reset();
  EXPECT_TRUE(ended.empty());
}

TEST_F(GatewayKeeperTest, EndsTheProcessThatRuns) {
  ASSERT_TRUE(sut->start(now));
  sut.reset();
  EXPECT_EQ(ended, std::vector{pid});
}

}  // namespace
}  // namespace swarm::launcher
