// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/topics.hpp"

#include <fstream>
#include <limits>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "swarm_link/event_names.hpp"
#include "swarm_link/monitor_topics.hpp"
#include "swarm_link/raw_port.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::link {
namespace {

/// The cell that a topic name stands for.
Cell parsed(const std::string& name) {
  static const std::regex kName(R"(swarm/cell/(m?)(\d+)_(m?)(\d+))");
  std::smatch match;
  EXPECT_TRUE(std::regex_match(name, match, kName)) << name;
  const auto number = [&](std::size_t sign) {
    const std::int64_t size = std::stoll(match[sign + 1]);
    return static_cast<std::int32_t>(match[sign].length() > 0 ? -size : size);
  };
  return {number(1), number(3)};
}

TEST(CellTopic, IsNamedByItsCellAlone) {
  constexpr auto kLeast = std::numeric_limits<std::int32_t>::min();
  constexpr auto kMost = std::numeric_limits<std::int32_t>::max();
  Rng rng(31);
  std::vector<Cell> cells = {{0, 0}, {3, -2}, {kLeast, kMost}, {kMost, kLeast}, {-1, 1}, {1, -1}};
  for (int i = 0; i < 1'000; ++i) {
    cells.push_back({static_cast<std::int32_t>(rng()), static_cast<std::int32_t>(rng())});
  }
  for (const Cell& cell : cells) EXPECT_EQ(parsed(cell_topic(cell).name), cell);
  EXPECT_EQ(cell_topic({3, -2}).name, "swarm/cell/3_m2");
}

TEST(RawTopic, OfStatusesAloneHasAKey) {
  EXPECT_TRUE(raw_topic(status_topic()).keyed);
  EXPECT_TRUE(raw_topic(relayed_status_topic()).keyed) << "depth counts per group of robots";
  EXPECT_FALSE(raw_topic(plan_topic()).keyed);
  EXPECT_FALSE(raw_topic(event_topic()).keyed);
  EXPECT_EQ(raw_topic(scene_topic()).qos, scene_topic().qos);
  EXPECT_EQ(raw_topic(scene_topic()).name, "swarm/scene");
  EXPECT_EQ(raw_topic(scene_topic()).type, "swarm::wire::Scene");
}

// Only a message that a process cannot miss for good may be sent without history.
TEST(Topics, GiveALateReaderTheStateOfTheMission) {
  const auto has_history = [](const Qos& qos) {
    return qos.reliability == Reliability::kReliable &&
           qos.durability == Durability::kTransientLocal;
  };
  EXPECT_TRUE(has_history(plan_topic().qos));
  EXPECT_TRUE(has_history(scene_topic().qos));
  EXPECT_TRUE(has_history(command_topic().qos));
  EXPECT_TRUE(has_history(event_topic().qos));
  EXPECT_TRUE(has_history(relayed_event_topic().qos));
  EXPECT_FALSE(has_history(heartbeat_topic().qos)) << "a repeated heartbeat would be outdated";
}

TEST(Topics, DifferForTheUnacknowledgedReaderInReliabilityAlone) {
  Topic<StatusMessage> expected = status_topic();
  expected.qos.reliability = Reliability::kBestEffort;
  EXPECT_EQ(status_topic_unacknowledged().qos, expected.qos);
  EXPECT_EQ(status_topic_unacknowledged().name, expected.name);
}

/// Struct by topic, as the comments of an IDL file have it: `Topic swarm/plan.` before FlowPlan.
std::map<std::string, std::string> structs_by_topic(const std::string& file) {
  std::ifstream in(std::string(SWARM_SOURCE_DIR) + "/idl/" + file);
  std::stringstream text;
  text << in.rdbuf();
  static const std::regex kBreak(R"(\n// )");
  static const std::regex kTopic(R"(Topic ([a-z_/<>]+)\.[^\n]*\n@final\nstruct (\w+))");
  const std::string joined = std::regex_replace(text.str(), kBreak, " ");
  std::map<std::string, std::string> found;
  for (std::sregex_iterator it(joined.begin(), joined.end(), kTopic), end; it != end; ++it) {
    found[(*it)[1]] = (*it)[2];
  }
  return found;
}

TEST(Topics, AreThoseThatTheIdlNames) {
  std::map<std::string, std::string> expected = {{"swarm/cell/<x>_<y>", "CellStates"}};
  const auto add = [&](const auto& topic) {
    expected[topic.name] = raw_topic(topic).type.substr(std::string("swarm::wire::").size());
  };
  add(plan_topic());
  add(scene_topic());
  add(command_topic());
  add(heartbeat_topic());
  add(status_topic());
  add(event_topic());
  EXPECT_EQ(structs_by_topic("swarm.idl"), expected);
  EXPECT_EQ(raw_topic(cell_topic({0, 0})).type, "swarm::wire::CellStates");
}

TEST(MonitorTopics, ContainEveryRecordOfTheRobotLogUnderTheNameOfTheIdl) {
  std::map<std::string, std::string> found;
  for (const MonitorTopic& topic : monitor_topics()) {
    const std::string prefix = "swarm::blackbox::";
    if (!topic.wire.type.starts_with(prefix)) continue;
    EXPECT_EQ(topic.wire.name, topic.recorded);
    found[topic.recorded] = topic.wire.type.substr(prefix.size());
  }
  EXPECT_EQ(found, structs_by_topic("blackbox.idl"));
}

TEST(MonitorTopics, AreRecordedUnderTheNamesThatRobotsUse) {
  std::set<std::string> recorded, on_the_bus;
  for (const MonitorTopic& topic : monitor_topics()) {
    EXPECT_TRUE(recorded.insert(topic.recorded).second) << topic.recorded;
    EXPECT_TRUE(on_the_bus.insert(topic.wire.name).second) << topic.wire.name;
  }
  for (const std::string& name :
       {plan_topic().name, scene_topic().name, command_topic().name, heartbeat_topic().name,
        status_topic().name, event_topic().name}) {
    EXPECT_TRUE(recorded.contains(name)) << name;
  }
  EXPECT_FALSE(on_the_bus.contains(status_topic().name)) << "the launcher's own topic instead";
  EXPECT_FALSE(on_the_bus.contains(states_topic().wire.name)) << "sent by cells";
  EXPECT_EQ(states_topic().wire.type, raw_topic(cell_topic({0, 0})).type);
}

TEST(SourceName, IsThatOfTheProcess) {
  EXPECT_EQ(source_name(kPlannerSource), "planner");
  EXPECT_EQ(source_name(kLauncherSource), "launcher");
  EXPECT_EQ(source_name(0), "robot-0");
  EXPECT_EQ(source_name(kLauncherSource - 1), "robot-4294967293");
}

TEST(SeverityName, IsKnownForEveryOctet) {
  const std::vector<std::string_view> names = {"info", "warning", "error"};
  for (std::size_t octet = 0; octet < 256; ++octet) {
    EXPECT_EQ(to_string(static_cast<Severity>(octet)),
              octet < names.size() ? names[octet] : "unknown");
  }
}

}  // namespace
}  // namespace swarm::link
