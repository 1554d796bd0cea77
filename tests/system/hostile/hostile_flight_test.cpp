// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Every bad message of one table, and forgeries that are well-formed, sent to every process of a
// flying swarm over every kind of bus: counted and reported by each process that receives its
// topic, and the flight goes on as if nothing had come.
#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include "swarm_core/app/file_watch.hpp"
#include "swarm_core/base/clock.hpp"
#include "tests/conformance/receivers/bad_messages.hpp"
#include "tests/system/flown_run.hpp"
#include "tests/system/hostile/intruder.hpp"

namespace swarm::test {
namespace {

using namespace swarm::link;
using conformance::Case;

constexpr int kRobots = 8;

/// Robots cross a part of the small mission's yard. Heartbeats are so rare that a busy machine does
/// not pass for a silent planner, whose place another one may take.
constexpr const char* kMission = R"(version: 1
name: crossing
world: {bounds_m: [0, 0, 40, 30]}
robots: {count: 8, radius_m: 0.2}
start: [{mean_m: [8, 15], covariance_m2: [[3, 0], [0, 4]], weight: 1}]
goal: [{mean_m: [18, 15], covariance_m2: [[3, 0], [0, 4]], weight: 1}]
timing: {heartbeat_hz: 2, planner_silence_s: 8}
planner: {samples: 100, connection_radius_m: 12, sigma_min_m: 0.8, sigma_max_m: 2.5}
launcher: {time_limit_s: 120}
)";

class HostileFlight : public ::testing::Test {
 protected:
  HostileFlight() { std::ofstream(mission()) << kMission; }
  std::string mission() const { return (folder_.path() / "mission.yaml").string(); }

  /// Of `swarm_launcher command`; what it prints goes to `answer`.
  int command(const FlownRun& run, std::vector<std::string> line) {
    line.insert(line.begin(), {"command", run.dir().string()});
    Program program("swarm_launcher", line);
    const int code = program.wait();
    answer_ = program.out() + program.err();
    return code;
  }

  std::string answer_;

 private:
  TemporaryFolder folder_;
};

/// Who reported which reason: "robot-3 not-finite".
std::set<std::string> refusals(const FlownRun& run) {
  std::set<std::string> reports;
  std::istringstream lines(read_text(run.dir() / "events.jsonl"));
  for (std::string line; std::getline(lines, line);) {
    const auto event = nlohmann::json::parse(line, nullptr, false);
    if (!event.is_object() || event["code"] != "refused") continue;
    const std::string text = event["text"];
    reports.insert(event["source"].get<std::string>() + text.substr(text.find(": ") + 1));
  }
  return reports;
}

/// Bad messages that are sent in flight. Left out are those that are good unless the one that they
/// follow was received, and heartbeats of a planner that began earlier: of two the first leads.
std::vector<Case> cases_for(std::uint64_t planner_epoch) {
  static const std::set<std::string> kLeftOut = {"PlanAgain", "HeartbeatAgain",
                                                 "HeartbeatOfAForeignEpoch"};
  auto cases = conformance::all_cases({.now = utc_now(), .epoch = planner_epoch});
  std::erase_if(cases, [](const Case& c) { return kLeftOut.contains(c.name); });
  const std::int64_t now = conformance::ns_after(0);
  const auto forged = [&](const char* name, conformance::AnyMessage message) {
    cases.push_back({.name = name, .bad = std::move(message), .reason = RefusalReason::kForged});
  };
  forged(
      "StatusInARobotsName",
      StatusMessage{.first_robot_id = 2,
                    .plan_version = 1,
                    .command_id = conformance::kHuge,
                    .stamp_utc_ns = now,
                    .robots = {{.robot_id = 2, .mode = RobotMode::kStopped, .x_m = 8, .y_m = 15}}});
  forged("EventInARobotsName",
         EventMessage{.source = 3, .stamp_utc_ns = now, .code = "robot-fault", .text = "forged"});
  for (const std::uint32_t source : {3U, kPlannerSource}) {
    forged("LostRecords", EventMessage{.source = source,
                                       .stamp_utc_ns = now,
                                       .code = std::string(shell::kRecordsLost),
                                       .text = "forged: all of it"});
  }
  return cases;
}

/// Who must report a bad message; the planner accepts heartbeats of any planner in any order.
std::vector<std::string> receivers_of(const Case& c) {
  // Neither vendor delivers them.
  const bool is_delivered =
      !std::holds_alternative<StatusMessage>(c.bad) && !std::holds_alternative<EventMessage>(c.bad);
  if (c.reason == RefusalReason::kOversized && !is_delivered) return {};
  if (c.only == "Launcher") return {"launcher"};
  if (c.only == "Agent") return {"robot-0"};
  if (c.only == "Gateway") return {};
  std::vector<std::string> programs;
  const bool is_order = c.reason == RefusalReason::kStale;
  const auto is = [&]<class... M>() { return (std::holds_alternative<M>(c.bad) || ...); };
  if (is.operator()<PlanMessage, SceneMessage, HeartbeatMessage, CommandMessage,
                    CellStatesMessage>()) {
    for (int robot = 0; robot < kRobots; ++robot) {
      programs.push_back("robot-" + std::to_string(robot));
    }
  }
  if (is.operator()<SceneMessage, CommandMessage, StatusMessage>() ||
      (is.operator()<HeartbeatMessage>() && !is_order)) {
    programs.emplace_back("planner");
  }
  if (is.operator()<HeartbeatMessage, StatusMessage, EventMessage>()) {
    programs.emplace_back("launcher");
  }
  return programs;
}

/// Sends all cases once, one of each topic at a time: readers of some topics keep only the newest.
/// Adds what has to be reported.
void attack(Intruder& intruder, std::set<std::string>& expected) {
  std::vector<std::vector<Case>> by_topic(std::variant_size_v<conformance::AnyMessage>);
  for (Case& c : cases_for(intruder.planner_epoch())) {
    by_topic[c.bad.index()].push_back(std::move(c));
  }
  for (std::size_t i = 0; std::ranges::any_of(by_topic, [&](auto& t) { return i < t.size(); });
       ++i) {
    for (const auto& cases : by_topic) {
      if (i >= cases.size() || !intruder.write(cases[i].bad)) continue;
      const bool is_older = cases[i].reason == RefusalReason::kDuplicate;  // than the real newest
      const RefusalReason reason = is_older ? RefusalReason::kStale : cases[i].reason;
      for (const std::string& program : receivers_of(cases[i])) {
        expected.insert(program + " " + std::string(to_string(reason)));
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    intruder.look();
  }
}

/// The page's port, from "view: http://127.0.0.1:8000/".
std::uint16_t view_port(const std::string& text) {
  const std::size_t at = text.find("http://127.0.0.1:");
  return at == std::string::npos ? 0 : static_cast<std::uint16_t>(std::stoul(text.substr(at + 17)));
}

/// A value of the monitor's metrics; −1 if there is none.
double metric(std::uint16_t port, const std::string& name) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string reply;
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) {
    const std::string request = "GET /metrics HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
                                "\r\nConnection: close\r\n\r\n";
    ::send(fd, request.data(), request.size(), MSG_NOSIGNAL);
    std::string part(4096, '\0');
    for (ssize_t n = 0; (n = ::recv(fd, part.data(), part.size(), 0)) > 0;) {
      reply.append(part, 0, static_cast<std::size_t>(n));
    }
  }
  ::close(fd);
  const std::size_t at = reply.find("\n" + name + " ");
  return at == std::string::npos ? -1.0 : std::stod(reply.substr(at + name.size() + 2));
}

struct Bus {
  std::string name;
  std::vector<std::string> options;
  bool has_gateway = false;
};

class HostileFlightOn : public HostileFlight, public ::testing::WithParamInterface<Bus> {
 protected:
  /// Attacks a paused swarm until each process has reported all that it must refuse.
  void attack_until_reported(const FlownRun& run, Intruder& intruder) {
    std::set<std::string> expected;
    std::vector<std::string> missing;
    const bool is_reported = eventually([&] {
      attack(intruder, expected);
      missing.clear();
      std::ranges::set_difference(expected, refusals(run), std::back_inserter(missing));
      return missing.empty();
    });
    EXPECT_GT(expected.size(), 5U * kRobots);
    EXPECT_TRUE(is_reported) << "not reported: " << testing::PrintToString(missing);
  }
};

TEST_P(HostileFlightOn, GoesOnUnchanged) {
  std::vector<std::string> options = GetParam().options;
  options.emplace_back("--view");
  FlownRun run(options, mission());
  ASSERT_TRUE(run.mission_started()) << run.outcome();
  // A real scene, so that older ones are stale; and time for what follows.
  ASSERT_EQ(command(run, {"add_obstacle", "circle_m: {center: [35, 25], radius: 1}"}), 0)
      << answer_;
  ASSERT_EQ(command(run, {"pause"}), 0) << answer_;
  Intruder intruder(run);
  ASSERT_TRUE(eventually([&] { return intruder.is_in(kRobots); }));

  attack_until_reported(run, intruder);
  intruder.look();
  EXPECT_EQ(intruder.phase(), MissionPhase::kPaused);
  EXPECT_EQ(intruder.robots_in(RobotMode::kMoving), 0);
  EXPECT_EQ(intruder.robots_in(RobotMode::kStopped), 0);
  const std::uint16_t port = view_port(run.launcher().err());
  EXPECT_GT(metric(port, "swarm_messages_refused_total"), 20.0) << run.outcome();
  EXPECT_EQ(metric(port, "swarm_phase"), 2.0);

  ASSERT_EQ(command(run, {"resume"}), 0) << answer_;
  std::set<std::string> reported_before;
  attack(intruder, reported_before);  // while the robots move

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], kRobots);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
  EXPECT_GT(summary["refused_messages"], 100);
  if (GetParam().has_gateway) {
    const std::string log = read_text(run.dir() / "logs" / "gateway.log");
    EXPECT_NE(log.find(" refused"), std::string::npos) << log;
    EXPECT_EQ(log.find(" 0 refused"), std::string::npos) << log;
  }
}

INSTANTIATE_TEST_SUITE_P(Buses, HostileFlightOn,
                         testing::Values(Bus{"TopicsOfFastDds", {"--channel", "topics"}},
                                         Bus{"GroupsOfBothWithAGateway",
                                             {"--channel", "groups", "--by-gateway", "2"},
                                             true},
                                         Bus{"GroupsOfCyclone",
                                             {"--channel", "groups", "--dds", "cyclonedds"}}),
                         [](const auto& bus) { return bus.param.name; });

// A frozen robot has not stopped, whatever others publish in its name.
TEST_F(HostileFlight, AForgedStatusConfirmsNoStop) {
  FlownRun run({"--channel", "topics"}, mission());
  ASSERT_TRUE(run.mission_started()) << run.outcome();
  Intruder intruder(run);
  ASSERT_TRUE(eventually([&] { return intruder.is_in(kRobots); }));
  ASSERT_EQ(run.agents().size(), static_cast<std::size_t>(kRobots));
  const pid_t frozen = run.agents().at(4);
  ::kill(frozen, SIGSTOP);

  Program stop("swarm_launcher", {"command", run.dir().string(), "stop"});
  bool has_forged = false;
  for (int i = 0; i < 600 && stop.out().empty(); ++i) {
    intruder.look();
    if (intruder.command().kind == CommandKind::kStop) {
      has_forged = true;
      intruder.write(StatusMessage{
          .first_robot_id = 4,
          .plan_version = 1,
          .command_id = intruder.command().command_id,
          .stamp_utc_ns = utc_now().time_since_epoch().count(),
          .robots = {
              {.robot_id = 4, .mode = RobotMode::kStopped, .settled = true, .x_m = 8, .y_m = 15}}});
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }

  EXPECT_EQ(stop.wait(), 1);
  EXPECT_TRUE(has_forged);
  EXPECT_NE(stop.out().find("not confirmed by robots 4"), std::string::npos) << stop.out();
  EXPECT_TRUE(refusals(run).contains("launcher forged"));
  ::kill(frozen, SIGCONT);
  EXPECT_EQ(run.launcher().wait(), 1);
}

}  // namespace
}  // namespace swarm::test
