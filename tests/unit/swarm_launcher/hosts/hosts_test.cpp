// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "swarm_launcher/hosts/host_watch.hpp"
#include "swarm_launcher/hosts/line_socket.hpp"
#include "swarm_launcher/hosts/offer.hpp"

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;
SteadyTime at(int ms) { return SteadyTime(milliseconds(ms)); }

TEST(HostWatch, ReportsOnceThatAHostIsCutOffAndOnceThatItIsBack) {
  HostWatch sut(50, {}, at(0));
  EXPECT_FALSE(sut.step(at(5000))) << "one that was never received is not cut off";

  sut.on_status(at(5000));
  EXPECT_FALSE(sut.step(at(5900)));
  EXPECT_EQ(sut.step(at(6100)), HostWatch::Change::kCut);
  EXPECT_FALSE(sut.step(at(6200)));
  EXPECT_TRUE(sut.cut());

  sut.on_status(at(9000));
  EXPECT_EQ(sut.step(at(9010)), HostWatch::Change::kBack);
  EXPECT_FALSE(sut.cut());
}

TEST(HostWatch, WaitsLongerForOneRobotThanForMany) {
  HostWatch one(1, {}, at(0));
  one.on_status(at(0));
  EXPECT_FALSE(one.step(at(2400)));
  EXPECT_TRUE(one.step(at(2600)));
  HostWatch rare(1, {.status_hz = 0.2}, at(0));
  rare.on_status(at(0));
  EXPECT_FALSE(rare.step(at(12'400)));
  EXPECT_FALSE(rare.lost(at(100'000)));
  EXPECT_TRUE(rare.lost(at(130'000)));
}

TEST(HostWatch, GivesUpAHostThatDoesNotReportWithinHalfTheTimeOfTheQuorum) {
  const HostWatch patient(50, {.quorum_timeout_s = 60.0}, at(3000));
  EXPECT_FALSE(patient.lost(at(33'000)));
  EXPECT_TRUE(patient.lost(at(33'001)));
}

TEST(HostWatch, GivesAHostTenSecondsForItsFirstStatusAtLeast) {
  HostWatch sut(50, {.quorum_timeout_s = 5.0}, at(3000));
  EXPECT_FALSE(sut.lost(at(13'000)));
  EXPECT_TRUE(sut.lost(at(13'001)));
  EXPECT_FALSE(sut.was_received());

  sut.on_status(at(12'000));
  EXPECT_TRUE(sut.was_received());
  EXPECT_FALSE(sut.lost(at(72'000)));
  EXPECT_TRUE(sut.lost(at(72'001))) << "one that was received may be cut off for longer";
}

TEST(HostWatch, CountsAnewAfterTheLauncherWasSuspended) {
  HostWatch sut(50, {}, at(0));
  sut.on_status(at(1000));
  sut.restart(at(90'000));
  EXPECT_FALSE(sut.lost(at(150'000)));
  EXPECT_TRUE(sut.lost(at(150'001)));
  HostWatch absent(50, {}, at(0));
  absent.restart(at(90'000));
  EXPECT_FALSE(absent.was_received());
}

TEST(HostPort, IsReadOrRefused) {
  const auto good = parse_host_port("10.0.0.1:7000");
  ASSERT_TRUE(good);
  EXPECT_EQ(good->host, "10.0.0.1");
  EXPECT_EQ(good->port, 7000);
  for (const char* bad : {"", "10.0.0.1", ":7000", "10.0.0.1:", "a:b", "a:70000", "a:7 "}) {
    EXPECT_FALSE(parse_host_port(bad)) << bad;
  }
}

HostOffer offer() {
  return {
      .run = {.domain = 7, .relays = 2, .host = "10.0.0.1", .channel = Channel::kGroups, .seed = 3},
      .first_robot = 50,
      .robots = 25,
      .per_process = 1,
      .first_process = 50,
      .mission_yaml = "mission: x\n"};
}

TEST(HostOffer, ComesBackAsItWas) {
  const auto back = parse_offer(to_line(offer()));

  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->run.domain, 7U);
  EXPECT_EQ(back->run.relays, 2U);
  EXPECT_EQ(back->run.host, "10.0.0.1");
  EXPECT_EQ(back->run.seed, 3U);
  EXPECT_EQ(back->first_robot, 50U);
  EXPECT_EQ(back->robots, 25U);
  EXPECT_EQ(back->mission_yaml, "mission: x\n");
}

TEST(HostOffer, OfSomebodyElseIsRefused) {
  HostOffer senseless = offer();
  senseless.run.domain = 5000;
  HostOffer empty = offer();
  empty.robots = 0;
  for (const std::string& line :
       {std::string("HTTP/1.1 400 Bad Request"), std::string("{}"), std::string("[1, 2]"),
        std::string(R"({"version": 2})"), std::string(R"({"version": "one"})"),
        std::string(R"({"refused": "no"})"), to_line(senseless), to_line(empty)}) {
    EXPECT_FALSE(parse_offer(line)) << line;
  }
}

TEST(LineSocket, CarriesLinesAndBytesBetweenThem) {
  auto server = LineServer::listen({"127.0.0.1", 0});
  ASSERT_TRUE(server) << server.error().message;
  auto here = LineSocket::connect({"127.0.0.1", server->port()});
  ASSERT_TRUE(here) << here.error().message;
  auto there = server->accept();
  ASSERT_TRUE(there);
  const std::string block(3'000'000, 'x');

  here->send("first");
  here->send_bytes(block);
  here->send("last");
  std::string got;
  std::optional<std::string> line;
  for (int i = 0; i < 10'000 && !line; ++i) {
    here->flush();
    there->wait(10);
    there->receive();
    line = there->line();
  }
  ASSERT_EQ(line, "first");
  for (int i = 0; i < 10'000 && got.size() < block.size(); ++i) {
    here->flush();
    there->wait(10);
    there->receive();
    got += there->bytes(block.size() - got.size());
  }
  EXPECT_EQ(got, block);
  for (int i = 0; i < 100 && !(line = there->line()); ++i) {
    here->flush();
    there->wait(10);
    there->receive();
  }
  EXPECT_EQ(line, "last");
  EXPECT_EQ(here->own_address(), "127.0.0.1");
}

}  // namespace
}  // namespace swarm::launcher
