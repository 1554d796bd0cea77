// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A participant that reports events without end.
#include <chrono>
#include <string>
#include <thread>

#include "swarm_launcher/supervision/event_throttle.hpp"
#include "swarm_link/topics.hpp"
#include "tests/system/hostile/intruder.hpp"

namespace swarm::test {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t number = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++number;
  return number;
}

TEST(EventFlood, FillsNeitherTheLogNorTheDisk) {
  using launcher::EventThrottle;
  FlownRun run({"--channel", "topics"});
  ASSERT_TRUE(run.mission_started()) << run.outcome();
  const auto participant = intrude(run);
  ASSERT_TRUE(participant) << participant.error().message;
  const auto events = (*participant)->make_writer(link::event_topic()).value();
  ASSERT_TRUE(eventually([&] { return events->matched() >= 1; }));
  const auto begin = std::chrono::steady_clock::now();

  for (int i = 0; i < 5000; ++i) {
    events->write({.source = link::kPlannerSource,  // a robot's are of its own sender alone
                   .stamp_utc_ns = utc_ns(),
                   .code = "flood",
                   .text = "again"});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  const double lasted_s = to_seconds(std::chrono::steady_clock::now() - begin);
  const auto logged = count(read_text(run.dir() / "events.jsonl"), "\"flood\"");
  EXPECT_GE(static_cast<double>(logged), EventThrottle::kBurst) << "it is no flood";
  EXPECT_LE(static_cast<double>(logged),
            EventThrottle::kBurst + EventThrottle::kPerSecond * lasted_s + 1);
  EXPECT_EQ(run.summary()["arrived"], 12);
}

}  // namespace
}  // namespace swarm::test
