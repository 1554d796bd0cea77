// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What answers at the address to join is no launcher, and its offer is made to write files.
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "swarm_launcher/hosts/line_socket.hpp"
#include "swarm_launcher/hosts/offer.hpp"
#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

using launcher::LineServer;
using launcher::LineSocket;

// The host of an offer becomes a part of the configuration of Cyclone DDS, which can name files.
TEST(FalseLauncher, CannotMakeAHostThatJoinsWriteFiles) {
  const TemporaryFolder folder;
  const auto trace = folder.path() / "trace";
  auto server = LineServer::listen({.host = "127.0.0.1", .port = 0});
  ASSERT_TRUE(server) << server.error().message;
  Program host("swarm_launcher",
               {"join", fmt::format("127.0.0.1:{}", server->port()), "--robots", "1", "--dds",
                "cyclonedds", "--out", (folder.path() / "run").string()});
  std::optional<LineSocket> peer;
  ASSERT_TRUE(eventually([&] { return (peer = server->accept()).has_value(); })) << host.err();
  ASSERT_TRUE(eventually([&] {
    peer->receive();
    return peer->line().has_value();
  })) << "it asks for robots";

  const UtcTime now(std::chrono::system_clock::now().time_since_epoch());
  launcher::HostOffer offer{.run = {.domain = 1, .relays = 1, .seed = 1, .began = now},
                            .first_robot = 0,
                            .robots = 1,
                            .per_process = 1,
                            .first_process = 1,
                            .mission_yaml = read_text(kSmallMission),
                            .sent_at = now};
  ASSERT_TRUE(launcher::parse_offer(to_line(offer))) << "but for its host it is a good one";
  offer.run.host = "--><Peer address='127.0.0.1:9'/></Peers></Discovery><Tracing><OutputFile>" +
                   trace.string() + "</OutputFile></Tracing><!--";
  peer->send(to_line(offer));

  EXPECT_EQ(host.wait(), 3) << host.err();
  EXPECT_NE(host.err().find("no launcher"), std::string::npos) << host.err();
  EXPECT_FALSE(std::filesystem::exists(trace));
}

}  // namespace
}  // namespace swarm::test
