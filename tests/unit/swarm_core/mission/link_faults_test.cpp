// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/link_faults.hpp"

#include <gtest/gtest.h>

namespace swarm {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(ParseLinkFaults, ReadsEveryKey) {
  const auto faults = parse_link_faults("loss=0.2,delay-ms=150,jitter-ms=50,from=10,to=60.5");

  ASSERT_TRUE(faults) << faults.error().message;
  EXPECT_DOUBLE_EQ(faults->loss, 0.2);
  EXPECT_EQ(faults->delay, milliseconds(150));
  EXPECT_EQ(faults->jitter, milliseconds(50));
  EXPECT_FALSE(faults->at(milliseconds(9'999)));
  EXPECT_TRUE(faults->at(seconds(10)));
  EXPECT_TRUE(faults->at(milliseconds(60'499)));
  EXPECT_FALSE(faults->at(milliseconds(60'500)));
}

TEST(ParseLinkFaults, LeavesOutWhatIsNotGiven) {
  const auto none = parse_link_faults("");
  ASSERT_TRUE(none);
  EXPECT_FALSE(none->any());

  const auto late = parse_link_faults("delay-ms=20");
  ASSERT_TRUE(late);
  EXPECT_TRUE(late->any());
  EXPECT_DOUBLE_EQ(late->loss, 0.0);
  EXPECT_TRUE(late->at(seconds(0)));
  EXPECT_TRUE(late->at(seconds(1'000'000)));
}

TEST(ParseLinkFaults, ChoosesWhoReceivesBadly) {
  const auto all = parse_link_faults("loss=1");
  EXPECT_TRUE(all->at_robots(0, 1));
  EXPECT_TRUE(all->at_planner());
  EXPECT_FALSE(all->at_launcher);
  const auto some = parse_link_faults("duplicate=0.5,robots=3-5,launcher=1");
  ASSERT_TRUE(some) << some.error().message;
  EXPECT_DOUBLE_EQ(some->duplicate, 0.5);
  EXPECT_TRUE(some->any());
  EXPECT_FALSE(some->at_robots(0, 3));
  EXPECT_TRUE(some->at_robots(0, 4));
  EXPECT_TRUE(some->at_robots(5, 1));
  EXPECT_FALSE(some->at_robots(6, 10));
  EXPECT_FALSE(some->at_planner());
  EXPECT_TRUE(some->at_launcher);
  EXPECT_TRUE(parse_link_faults("robots=7")->at_robots(7, 1));
}

TEST(Fate, OfCopiesHasItsShareAndDelays) {
  const LinkFaults faults{
      .delay = milliseconds(150), .jitter = milliseconds(50), .duplicate = 0.25};
  int copies = 0;
  for (std::uint64_t message = 0; message < 10'000; ++message) {
    const auto delay = fate_of_copy(faults, 7, message);
    if (!delay) continue;
    ++copies;
    EXPECT_GE(*delay, milliseconds(100));
    EXPECT_LE(*delay, milliseconds(200));
  }
  EXPECT_NEAR(copies, 2500, 150);
  EXPECT_FALSE(fate_of_copy({.delay = milliseconds(1)}, 7, 1));
}

TEST(ParseLinkFaults, ReportsWhatIsWrong) {
  const std::pair<const char*, const char*> cases[] = {
      {"loss", "'loss' is not KEY=NUMBER"},
      {"loss=", "'loss=' is not KEY=NUMBER"},
      {"loss=0.1x", "'loss=0.1x' is not KEY=NUMBER"},
      {"loss=nan", "'loss=nan' is not KEY=NUMBER"},
      {"loss=1.5", "'loss=1.5' is not in 0 to 1"},
      {"delay-ms=-1", "'delay-ms=-1' is not in 0 to 60000"},
      {"drop=0.1", "'drop=0.1' has an unknown key"},
      {"loss=0.1,,", "'' is not KEY=NUMBER"},
      {"robots=5-3", "'robots=5-3' names no robots"},
      {"robots=-3", "'robots=-3' names no robots"},
      {"robots=3-", "'robots=3-' names no robots"},
      {"launcher=2", "'launcher=2' is not in 0 to 1"},
      {"from=5,to=5", "'to' is not after 'from'"}};
  for (const auto& [text, complaint] : cases) {
    const auto faults = parse_link_faults(text);
    ASSERT_FALSE(faults) << text;
    EXPECT_EQ(faults.error().code, ErrorCode::kBadInput);
    EXPECT_NE(faults.error().message.find(complaint), std::string::npos) << faults.error().message;
  }
}

TEST(Fate, LosesTheShareAndSpreadsTheRest) {
  const LinkFaults faults{.loss = 0.25, .delay = milliseconds(150), .jitter = milliseconds(50)};
  int lost = 0;
  Duration earliest = seconds(1), latest{};
  for (std::uint64_t message = 0; message < 10'000; ++message) {
    const auto delay = fate(faults, 7, message);
    if (!delay) {
      ++lost;
      continue;
    }
    earliest = std::min(earliest, *delay);
    latest = std::max(latest, *delay);
    EXPECT_EQ(fate(faults, 7, message), delay);
  }
  EXPECT_NEAR(lost, 2500, 150);  // 3.5 sigma
  EXPECT_GE(earliest, milliseconds(100));
  EXPECT_LE(earliest, milliseconds(101));
  EXPECT_LE(latest, milliseconds(200));
  EXPECT_GE(latest, milliseconds(199));
}

TEST(Fate, IsNeverBeforeTheMessage) {
  const LinkFaults faults{.delay = milliseconds(10), .jitter = milliseconds(50)};
  for (std::uint64_t message = 0; message < 100; ++message) {
    EXPECT_GE(fate(faults, 1, message), Duration::zero());
  }
}

}  // namespace
}  // namespace swarm
