// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/program/heartbeat_thread.hpp"

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace swarm::planner {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// What was published, kept beyond the writer.
struct Published {
  std::mutex mutex;
  std::vector<link::HeartbeatMessage> beats;

  std::vector<link::HeartbeatMessage> all() {
    const std::scoped_lock lock(mutex);
    return beats;
  }
};

class KeepingWriter final : public link::Writer<link::HeartbeatMessage> {
 public:
  explicit KeepingWriter(Published& published) : published_(published) {}
  bool write(const link::HeartbeatMessage& beat) override {
    const std::scoped_lock lock(published_.mutex);
    published_.beats.push_back(beat);
    return true;
  }
  int matched() const override { return 1; }

 private:
  Published& published_;
};

/// False if the condition does not become true within a minute, however slow the machine is.
bool eventually(const std::function<bool()>& condition) {
  for (int i = 0; i < 60'000 && !condition(); ++i) std::this_thread::sleep_for(milliseconds(1));
  return condition();
}

PlannerState state_now() {
  return {.phase = MissionPhase::kRunning,
          .clock = {.plan_version = 1, .plan_time_s = 5.0, .rate = 1.0},
          .at = std::chrono::steady_clock::now()};
}

TEST(HeartbeatThread, BeatsWhileTheLoopIsBusy) {
  Published published;
  HeartbeatThread sut(std::make_unique<KeepingWriter>(published),
                      HeartbeatSource(PlannerEpoch(5), seconds(600)), milliseconds(2));
  sut.on_step(state_now());
  ASSERT_TRUE(eventually([&] { return published.all().size() >= 20; }));
  const auto beats = published.all();
  for (std::size_t i = 0; i < beats.size(); ++i) {
    EXPECT_EQ(beats[i].sequence_number, i + 1);
    EXPECT_TRUE(i == 0 || beats[i].plan_time_s >= beats[i - 1].plan_time_s);
  }
  EXPECT_GE(sut.published().plan_time_s, beats.back().plan_time_s);
}

TEST(HeartbeatThread, NumbersBeatsOfTheLoopAndItsOwnInOneOrder) {
  Published published;
  {
    HeartbeatThread sut(std::make_unique<KeepingWriter>(published),
                        HeartbeatSource(PlannerEpoch(5), seconds(600)), milliseconds(1));
    sut.on_step(state_now());
    for (int i = 0; i < 200; ++i) {
      sut.on_step(state_now());
      sut.beat();
    }
    ASSERT_TRUE(eventually([&] { return published.all().size() > 220; }));
  }
  const auto beats = published.all();
  for (std::size_t i = 0; i < beats.size(); ++i) ASSERT_EQ(beats[i].sequence_number, i + 1);
}

TEST(HeartbeatThread, EndsAtOnceWithALongPeriodAndPublishesNothingWithoutAState) {
  Published published;
  {
    HeartbeatThread sut(std::make_unique<KeepingWriter>(published),
                        HeartbeatSource(PlannerEpoch(5), seconds(600)), std::chrono::hours(1));
    sut.beat();
  }
  EXPECT_TRUE(published.all().empty());
}

}  // namespace
}  // namespace swarm::planner
