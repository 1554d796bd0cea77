// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/upgrade_check.hpp"

#include <array>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace swarm::monitor {
namespace {

constexpr std::array<std::string_view, 2> kOpen = {"open.v1", "open.v2"};
constexpr ServedProtocols kServed{"page.v1", "/ws", kOpen};

UpgradeRequest good() {
  return {.get = true,
          .http = "HTTP/1.1",
          .path = "/ws",
          .host = "localhost:80",
          .upgrade = "websocket",
          .connection = "keep-alive, Upgrade",
          .key = "dGhlIHNhbXBsZSBub25jZQ==",
          .version = "13",
          .protocols = "page.v1"};
}

/// The status of the refusal of a request that differs from a good one; 0: it is opened.
int status(const std::function<void(UpgradeRequest&)>& change) {
  UpgradeRequest request = good();
  change(request);
  const auto refusal = upgrade_refusal(request, kServed, {});
  EXPECT_TRUE(!refusal || !refusal->text.empty());
  return refusal ? refusal->status : 0;
}

TEST(UpgradeCheck, OpensWhatTheServerKnows) {
  EXPECT_EQ(status([](UpgradeRequest&) {}), 0);
  EXPECT_EQ(status([](UpgradeRequest& r) { r.upgrade = "WebSocket"; }), 0);
  EXPECT_EQ(status([](UpgradeRequest& r) { r.origin = "http://localhost:80"; }), 0);
  EXPECT_EQ(status([](UpgradeRequest& r) { r.protocols = "chat,\t page.v1"; }), 0);
}

TEST(UpgradeCheck, OpensOpenProtocolsAtAnyPathToAnyOrigin) {
  for (const char* name : {"open.v1", "chat, open.v2", "open.v1,page.v1"}) {
    EXPECT_EQ(status([&](UpgradeRequest& r) {
                r.protocols = name;
                r.path = "/any";
                r.origin = "https://elsewhere.example";
              }),
              0)
        << name;
  }
}

TEST(UpgradeCheck, AnswersWhatItDoesNotOpen) {
  EXPECT_EQ(status([](UpgradeRequest& r) { r.get = false; }), 405);
  EXPECT_EQ(status([](UpgradeRequest& r) { r.upgrade = "h2c"; }), 400);
  EXPECT_EQ(status([](UpgradeRequest& r) { r.http = "HTTP/1.0"; }), 400);
  EXPECT_EQ(status([](UpgradeRequest& r) { r.connection = "close"; }), 400);
  EXPECT_EQ(status([](UpgradeRequest& r) { r.host = ""; }), 400);
  EXPECT_EQ(status([](UpgradeRequest& r) { r.key = ""; }), 400);
  EXPECT_EQ(status([](UpgradeRequest& r) { r.version = "8"; }), kStatusUpgradeRequired);
  for (const char* none : {"", " , ", "chat, superchat", "page.v1x", "PAGE.V1"}) {
    EXPECT_EQ(status([&](UpgradeRequest& r) { r.protocols = none; }), 400) << none;
  }
  EXPECT_EQ(status([](UpgradeRequest& r) { r.path = "/elsewhere"; }), 404);
}

TEST(UpgradeCheck, OpensThePagesProtocolToThePageAlone) {
  for (const char* origin : {"http://evil.example", "null", "", "http://localhost:81"}) {
    EXPECT_EQ(status([&](UpgradeRequest& r) { r.origin = origin; }), 403) << origin;
  }
  EXPECT_EQ(status([](UpgradeRequest& r) { r.host = "evil.example"; }), 403);
}

TEST(UpgradeCheck, ReadsLists) {
  EXPECT_TRUE(list_has("a, B ,c", "b"));
  EXPECT_FALSE(list_has("ab", "a"));
  EXPECT_FALSE(list_has("", ""));
}

}  // namespace
}  // namespace swarm::monitor
