// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The launcher's side of other hosts, with hosts that follow the protocol and hosts that do not.
#include "swarm_launcher/hosts/remote_hosts.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "swarm_core/base/clock.hpp"
#include "swarm_launcher/hosts/last_position.hpp"

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint32_t kRobots = 4;  // two of them remote

struct Bench {
  explicit Bench(const std::string& secret = {}) : token(secret) {
    std::filesystem::create_directories(dir / "blackbox");
    for (int i = 0; i < 20; ++i) {
      supervisor.step(now);
      now += milliseconds(50);
    }
  }
  ~Bench() { std::filesystem::remove_all(dir); }

  void step(int times = 3) {
    for (int i = 0; i < times; ++i) {
      for (const LogEvent& event : hosts.step(supervisor, now)) log.push_back(event.code);
      for (const Action& action : supervisor.step(now)) {
        if (const auto* signal = std::get_if<SignalProcess>(&action)) {
          if (signal->process.value() > kRobots - 2) {
            hosts.end(signal->process, signal->signal);
          } else {
            supervisor.on_exit(signal->process, {}, now);
          }
        }
      }
      now += milliseconds(50);
    }
  }

  /// Steps until the condition holds; the limit prevents an endless loop.
  bool until(const std::function<bool()>& condition) {
    for (int i = 0; i < 2000 && !condition(); ++i) {
      step(1);
      std::this_thread::sleep_for(milliseconds(1));
    }
    return condition();
  }

  LineSocket connect() { return *LineSocket::connect({"127.0.0.1", hosts.port()}); }
  LineSocket join(int robots) { return request("{\"join\":" + std::to_string(robots) + "}"); }
  LineSocket request(const std::string& text) {
    answer.clear();
    LineSocket socket = connect();
    socket.send(text);
    until([&] {
      socket.receive();
      if (auto line = socket.line()) answer = *line;
      return !answer.empty() || socket.gone();
    });
    return socket;
  }
  bool is_dropped(LineSocket& socket) {
    return until([&] {
      socket.receive();
      return socket.gone();
    });
  }
  void start_mission() {
    for (std::uint32_t i = 0; i < kRobots; ++i) {
      supervisor.on_status(RobotId(i), {true, true, RobotMode::kMoving, false});
      hosts.on_status(RobotId(i), now);
    }
    step();
  }
  bool logged(const std::string& code) const {
    return std::find(log.begin(), log.end(), code) != log.end();
  }

  std::string token;
  std::filesystem::path dir =
      std::filesystem::temp_directory_path() / ("swarmflow-hosts-" + std::to_string(::getpid()));
  SteadyTime now{seconds(100)};
  Supervisor supervisor{{.robots = kRobots, .remote_processes = 2, .launcher = {}, .script = {}},
                        now};
  RemoteHosts hosts{*LineServer::listen({"127.0.0.1", 0}),
                    {.run = {.domain = 1, .relays = 1},
                     .first_robot = 2,
                     .robots = 2,
                     .first_process = 2,
                     .mission_yaml = "x"},
                    {.quorum_timeout_s = 10.0},
                    dir,
                    token};
  std::vector<std::string> log;
  std::string answer;  // to the last join
};

TEST(RemoteHosts, GivesEachHostTheNextRobots) {
  Bench bench;
  LineSocket first = bench.join(1);
  EXPECT_EQ(parse_offer(std::exchange(bench.answer, ""))->first_robot, 2U);
  LineSocket second = bench.join(5);
  const auto rest = parse_offer(std::exchange(bench.answer, ""));
  EXPECT_EQ(rest->first_robot, 3U);
  EXPECT_EQ(rest->robots, 1U);
  LineSocket third = bench.join(1);
  EXPECT_NE(bench.answer.find("refused"), std::string::npos);
}

TEST(RemoteHosts, GivesTheRobotsOfOneThatFailedAtTheStartToTheNext) {
  Bench bench;
  bench.join(2).close();
  EXPECT_TRUE(bench.until([&] { return bench.logged("host-over"); }));
  EXPECT_EQ(bench.hosts.take_ended(), (std::vector{ProcessIndex(3), ProcessIndex(4)}));
  EXPECT_TRUE(bench.hosts.take_ended().empty());

  bench.answer.clear();
  LineSocket again = bench.join(2);
  EXPECT_EQ(parse_offer(bench.answer)->robots, 2U);
  bench.start_mission();
  EXPECT_EQ(bench.supervisor.stage(), Supervisor::Stage::kRunning);
  EXPECT_TRUE(bench.supervisor.lost().empty());
}

// As a join in a loop that fails each time.
TEST(RemoteHosts, GiveTheirRobotsAgainHoweverManyFailedAtTheStart) {
  Bench bench;
  constexpr std::ptrdiff_t kJoins = 260;
  for (std::ptrdiff_t i = 1; i <= kJoins; ++i) {
    bench.join(1).close();
    ASSERT_NE(bench.answer, "") << i;
    ASSERT_TRUE(bench.until([&] { return std::ranges::count(bench.log, "host-over") == i; })) << i;
  }

  LineSocket again = bench.join(2);

  EXPECT_EQ(parse_offer(bench.answer)->robots, 2U) << "in one block";
}

TEST(RemoteHosts, OneThatReportsAnExitAfterItsEndIsDropped) {
  Bench bench;
  LineSocket host = bench.join(2);
  bench.start_mission();
  host.send(R"({"over": true})");
  EXPECT_TRUE(bench.until([&] { return bench.logged("host-over"); }));

  host.send(R"({"exit": 0, "code": 0, "signal": 0, "restarts": false})");

  EXPECT_TRUE(bench.is_dropped(host));
}

TEST(RemoteHosts, AProcessThatItsHostDoesNotRestartIsLost) {
  Bench bench;
  LineSocket host = bench.join(2);
  bench.start_mission();

  host.send(R"({"exit": 1, "code": 0, "signal": 9, "restarts": false})");

  EXPECT_TRUE(bench.until([&] { return !bench.supervisor.lost().empty(); }));
  EXPECT_EQ(bench.supervisor.lost(), std::vector{RobotId(3)});
  EXPECT_EQ(bench.hosts.take_ended(), std::vector{ProcessIndex(4)});
  bench.step();
  EXPECT_EQ(bench.supervisor.stage(), Supervisor::Stage::kRunning);
}

TEST(RemoteHosts, AProcessThatItsHostRestartsIsWaitedFor) {
  Bench bench;
  LineSocket host = bench.join(2);
  bench.start_mission();

  host.send(R"({"exit": 0, "code": 2, "signal": 0, "restarts": true})");

  EXPECT_TRUE(bench.until([&] { return !bench.supervisor.silent().empty(); }));
  EXPECT_TRUE(bench.supervisor.lost().empty());
  EXPECT_EQ(bench.supervisor.silent(), std::vector{RobotId(2)});
  EXPECT_EQ(bench.hosts.take_ended(), std::vector{ProcessIndex(3)}) << "another sender follows";
  bench.supervisor.on_status(RobotId(2), {.has_plan = true,
                                          .receives_neighbours = true,
                                          .mode = RobotMode::kMoving,
                                          .sent_at = bench.now});
  EXPECT_TRUE(bench.supervisor.silent().empty());
}

std::string last_of(std::uint32_t robot, UtcTime at) {
  return to_line(
      LastPosition{.robot = RobotId(robot),
                   .known = {.at = at, .position_m = {3, 4}, .command_mps = Vec2(1, 0)}});
}

TEST(RemoteHosts, KnowTheLastStepsOfTheirRobots) {
  Bench bench;
  LineSocket host = bench.join(2);

  host.send(last_of(3, utc_now()));
  ASSERT_TRUE(bench.until([&] { return bench.hosts.last_known(RobotId(3)).has_value(); }));

  EXPECT_EQ(bench.hosts.last_known(RobotId(3))->position_m, Vec2(3, 4));
  EXPECT_FALSE(bench.hosts.last_known(RobotId(2)));
}

// The clock of a host may differ.
TEST(RemoteHosts, AStepOfTheFutureWasMadeNow) {
  Bench bench;
  LineSocket host = bench.join(2);

  host.send(last_of(3, utc_now() + seconds(60)));
  EXPECT_TRUE(bench.until([&] { return bench.hosts.last_known(RobotId(3)).has_value(); }));

  EXPECT_LE(bench.hosts.last_known(RobotId(3))->at, utc_now());
}

TEST(RemoteHosts, KeepTheNewestLineAboutARobot) {
  Bench bench;
  LineSocket host = bench.join(2);
  const UtcTime at = utc_now() - seconds(2);
  const LastPosition last{.robot = RobotId(3),
                          .known = {.at = at, .command_mps = Vec2(1, 0), .is_last = true}};
  host.send(to_line(last));
  ASSERT_TRUE(bench.until([&] { return bench.hosts.last_known(RobotId(3)).has_value(); }));
  EXPECT_TRUE(bench.hosts.last_known(RobotId(3))->is_last);

  host.send(last_of(3, at + seconds(1)));  // it makes steps again
  EXPECT_TRUE(bench.until([&] { return bench.hosts.last_known(RobotId(3))->at > at; }));
  EXPECT_FALSE(bench.hosts.last_known(RobotId(3))->is_last);
}

TEST(RemoteHosts, OneThatReportsTheStepOfAnotherIsDropped) {
  for (const std::string& line :
       {last_of(1, utc_now()), last_of(4, utc_now()), std::string(R"({"last":3})")}) {
    Bench bench;
    LineSocket host = bench.join(2);
    host.send(line);
    EXPECT_TRUE(bench.is_dropped(host)) << line;
    EXPECT_FALSE(bench.hosts.last_known(RobotId(3))) << line;
  }
}

TEST(RemoteHosts, OneThatReportsAProcessItDoesNotHaveIsDropped) {
  for (const char* line :
       {R"({"exit": 2, "code": 0, "signal": 9, "restarts": false})",
        R"({"exit": 0, "code": -1, "signal": 0, "restarts": false})",
        R"({"exit": 0, "code": 0, "signal": 0, "restarts": "yes"})", R"({"exit": 0})"}) {
    Bench bench;
    LineSocket host = bench.join(2);
    host.send(line);
    EXPECT_TRUE(bench.is_dropped(host)) << line;
  }
}

TEST(RemoteHosts, OneThatDisconnectsAtOnceDelaysNoOther) {
  Bench bench;
  {
    LineSocket hasty = bench.connect();
    hasty.send(R"({"join":2})");
  }
  ASSERT_TRUE(bench.until([&] { return bench.logged("host-over"); }));
  bench.supervisor.on_interrupt();
  bench.step(10);

  EXPECT_EQ(bench.supervisor.stage(), Supervisor::Stage::kDone);
}

TEST(RemoteHosts, OneThatDoesNotEndIsGivenUp) {
  Bench bench;
  LineSocket frozen = bench.join(2);
  bench.start_mission();
  bench.supervisor.on_interrupt();
  bench.step(10);
  EXPECT_EQ(bench.supervisor.stage(), Supervisor::Stage::kEnding);

  bench.supervisor.on_interrupt();
  bench.step(10);

  EXPECT_EQ(bench.supervisor.stage(), Supervisor::Stage::kDone);
  EXPECT_EQ(bench.hosts.missing_logs(), 2U);
}

TEST(RemoteHosts, PausesTheOthersWhileAHostIsSilentUnlessSomebodyResumes) {
  Bench bench;
  LineSocket host = bench.join(2);
  bench.start_mission();
  ASSERT_EQ(bench.supervisor.phase(), MissionPhase::kRunning);

  bench.step(50);
  EXPECT_TRUE(bench.logged("host-silent"));
  EXPECT_EQ(bench.supervisor.phase(), MissionPhase::kPaused);
  bench.supervisor.on_command(CommandKind::kResume, bench.now);
  bench.step(5);
  EXPECT_EQ(bench.supervisor.phase(), MissionPhase::kRunning);

  bench.start_mission();  // received again
  bench.step(60);         // and silent again
  EXPECT_EQ(bench.supervisor.phase(), MissionPhase::kPaused);
  bench.hosts.on_user_command(CommandKind::kPause);
  bench.start_mission();
  EXPECT_EQ(bench.supervisor.phase(), MissionPhase::kPaused) << "somebody wants it so";
}

TEST(RemoteHosts, OneThatJoinsAndNeverReportsIsDroppedAndItsRobotsAreFree) {
  Bench bench;
  LineSocket hog = bench.join(2);
  ASSERT_TRUE(parse_offer(bench.answer));
  bench.step(190);
  EXPECT_FALSE(bench.logged("host-absent"));
  bench.step(20);
  EXPECT_TRUE(bench.logged("host-absent"));
  EXPECT_TRUE(bench.is_dropped(hog));

  LineSocket host = bench.join(2);
  const auto offer = parse_offer(bench.answer);
  ASSERT_TRUE(offer) << bench.answer;
  EXPECT_EQ(offer->robots, 2U);
  bench.start_mission();
  EXPECT_EQ(bench.supervisor.stage(), Supervisor::Stage::kRunning);
}

TEST(RemoteHosts, GiveRobotsOnlyToWhoKnowsTheToken) {
  Bench bench("s3cret");
  for (const std::string line :
       {R"({"join":2})", R"({"join":2,"token":""})", R"({"join":2,"token":"s3cre"})",
        R"({"join":2,"token":"s3crets"})", R"({"join":2,"token":"S3cret"})",
        R"({"join":2,"token":7})", R"({"join":2,"token":["s3cret"]})"}) {
    LineSocket stranger = bench.request(line);
    EXPECT_NE(bench.answer.find("refused"), std::string::npos) << line;
    EXPECT_NE(bench.answer.find("--join-token"), std::string::npos) << line;
    EXPECT_TRUE(bench.is_dropped(stranger)) << line;
  }
  LineSocket host = bench.request(R"({"join":2,"token":"s3cret"})");
  EXPECT_TRUE(parse_offer(bench.answer)) << bench.answer;
}

TEST(RemoteHosts, WithoutATokenTakeAnyone) {
  Bench bench;
  LineSocket host = bench.request(R"({"join":2,"token":"whatever"})");
  EXPECT_TRUE(parse_offer(bench.answer)) << bench.answer;
}

TEST(RemoteHosts, CollectsRobotLogs) {
  Bench bench;
  LineSocket host = bench.join(2);
  host.send(R"({"over":true})");
  host.send(R"({"box":2,"bytes":3})");
  host.send_bytes("abc");
  host.send(R"({"box":3,"bytes":5})");
  host.send_bytes("de");  // and no more
  host.flush();
  EXPECT_TRUE(bench.until([&] { return bench.hosts.missing_logs() == 1; }));
  EXPECT_EQ(std::filesystem::file_size(bench.dir / "blackbox" / "robot-00002.mcap"), 3U);
  EXPECT_FALSE(bench.hosts.collect());

  host.close();
  EXPECT_TRUE(bench.until([&] { return bench.hosts.collect(); }));
  EXPECT_EQ(bench.hosts.missing_logs(), 1U) << "half a box is none";
}

TEST(RemoteHosts, DropsClientsWithAnotherProtocol) {
  Bench bench;
  for (const std::string line :
       {"GET / HTTP/1.1", "[]", R"({"join":0})", R"({"join":-1})", R"({"join":1e300})",
        R"({"join":"two"})", R"({"box":2,"bytes":1})", R"({"over":true})"}) {
    LineSocket stranger = bench.connect();
    stranger.send(line);
    EXPECT_TRUE(bench.is_dropped(stranger)) << line;
  }
  LineSocket host = bench.join(2);
  host.send(R"({"box":9,"bytes":1e300})");
  EXPECT_TRUE(bench.is_dropped(host));
}

}  // namespace
}  // namespace swarm::launcher
