// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/view_server.hpp"

#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "swarm_monitor/view/origin_check.hpp"
#include "tests/unit/swarm_monitor/fake_view_source.hpp"
#include "tests/unit/swarm_monitor/view_client.hpp"

namespace swarm::monitor {
namespace {

class ViewServerTest : public ::testing::Test {
 protected:
  void start(ViewServerOptions options = {}) {
    auto server = ViewServer::make(std::move(options), source_);
    ASSERT_TRUE(server.has_value()) << server.error().message;
    server_ = std::move(*server);
    ASSERT_NE(server_->port(), 0);
  }

  /// Serves until then, for two seconds at most.
  bool serve_until(ViewClient& client, const std::function<bool()>& done) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    while (std::chrono::steady_clock::now() < end) {
      server_->serve(std::chrono::milliseconds(2));
      client.read();
      if (done()) return true;
    }
    return false;
  }

  /// The head of the answer to what was sent; what follows stays in the input.
  std::string head(ViewClient& client) {
    serve_until(client, [&] {
      return client.input.find("\r\n\r\n") != std::string::npos || !client.open();
    });
    const std::size_t end = client.input.find("\r\n\r\n");
    if (end == std::string::npos) return {};
    std::string text = client.input.substr(0, end + 4);
    client.input.erase(0, end + 4);
    return text;
  }
  std::string get(const std::string& path, const std::string& method = "GET") {
    ViewClient client(server_->port());
    client.send(method + " " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    std::string text = head(client);
    serve_until(client, [&] { return !client.open(); });
    return text + client.input;
  }
  bool upgraded(ViewClient& client) { return head(client).starts_with("HTTP/1.1 101"); }

  std::optional<ViewClient::Message> message(ViewClient& client) {
    std::optional<ViewClient::Message> got;
    serve_until(client, [&] { return (got = client.message()).has_value(); });
    return got;
  }
  /// The next message of the kind.
  std::string text(ViewClient& client, const std::string& op) {
    while (const auto got = message(client)) {
      if (got->opcode == 1 && got->payload.find("\"op\":\"" + op + "\"") != std::string::npos) {
        return got->payload;
      }
    }
    return {};
  }
  std::string binary(ViewClient& client, char first) {
    while (const auto got = message(client)) {
      if (got->opcode == 2 && got->payload.starts_with(first)) return got->payload;
    }
    return {};
  }

  FakeViewSource source_;
  std::unique_ptr<ViewServer> server_;
};

TEST_F(ViewServerTest, ServesFilesWithHeadersThatKeepOthersOut) {
  start();
  const std::string script = get("/dygraph.min.js");
  EXPECT_TRUE(script.starts_with("HTTP/1.1 200"));
  EXPECT_GT(script.size(), 100'000U);
  EXPECT_NE(script.find("content-type: text/javascript"), std::string::npos);
  EXPECT_NE(script.find("x-content-type-options: nosniff"), std::string::npos);
  EXPECT_NE(script.find("cache-control: no-store"), std::string::npos);
  EXPECT_NE(script.find("content-security-policy: default-src 'none'; script-src 'self'"),
            std::string::npos);
}

TEST_F(ViewServerTest, ServesNothingElse) {
  start();
  for (const char* path :
       {"/../../etc/passwd", "/..%2f..%2fetc/passwd", "/%2e%2e/etc/passwd", "/page/", "/ws",
        "/etc/passwd", "/dygraph.min.js/", "/dygraph.min.js%00", "//dygraph.min.j"}) {
    const std::string answer = get(path);
    EXPECT_FALSE(answer.starts_with("HTTP/1.1 200")) << path;
    EXPECT_EQ(answer.find("root:"), std::string::npos) << path;
  }
  EXPECT_TRUE(get("/../../etc/passwd").starts_with("HTTP/1.1 404"));
  EXPECT_NE(get("/nothing").find("content-security-policy"), std::string::npos);
  EXPECT_TRUE(get("/", "POST").starts_with("HTTP/1.1 405"));
}

TEST_F(ViewServerTest, ServesMetricsOfTheSourceAndItsOwn) {
  start();
  const std::string answer = get("/metrics");
  EXPECT_NE(answer.find("swarm_robots 3\n"), std::string::npos);
  EXPECT_NE(answer.find("swarm_view_clients 0\n"), std::string::npos);
}

TEST_F(ViewServerTest, ShowsThePageWhatItAsksFor) {
  start();
  ViewClient client(server_->port());
  client.upgrade("/ws", "swarmflow.view.v1",
                 fmt::format("Origin: http://127.0.0.1:{}\r\n", server_->port()));
  ASSERT_TRUE(upgraded(client));
  EXPECT_EQ(text(client, "scene"), source_.scene_texts[0]);
  EXPECT_NE(text(client, "events"), "");
  EXPECT_NE(text(client, "series"), "");
  EXPECT_EQ(server_->clients(), 1U);
  client.send_text(R"({"op":"frame"})");
  EXPECT_EQ(binary(client, 'S').size(), 24U + 3 * 16 + 24 + 8);
  source_.event_texts.emplace_back(R"({"t":2,"text":"two"})");
  EXPECT_EQ(text(client, "events"), R"({"op":"events","events":[{"t":2,"text":"two"}]})");
  EXPECT_EQ(server_->counters().view_frames_sent, 1U);
}

TEST_F(ViewServerTest, TakesAMessageInFragments) {
  start();
  ViewClient client(server_->port());
  client.upgrade("/ws", "swarmflow.view.v1");
  ASSERT_TRUE(upgraded(client));
  client.send(ViewClient::frame(R"({"op":)", 1, false));
  client.send(ViewClient::frame("", 9));
  client.send(ViewClient::frame(R"("frame"})", 0, true));
  EXPECT_NE(binary(client, 'S'), "");
}

TEST_F(ViewServerTest, OpensThePagesSocketToThePageAlone) {
  start();
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"/ws", "Origin: http://evil.example\r\n"},
      {"/ws", "Origin: null\r\n"},
      {"/ws", "Origin: http://127.0.0.1:1\r\n"},
      {"/ws", fmt::format("Origin: http://{:a>2000}\r\n", "")},
      {"/elsewhere", ""}};
  for (const auto& [path, headers] : wrong) {
    ViewClient client(server_->port());
    client.upgrade(path, "swarmflow.view.v1", headers);
    EXPECT_EQ(head(client).substr(8, 4), path == "/ws" ? " 403" : " 404") << headers.substr(0, 60);
    EXPECT_TRUE(serve_until(client, [&] { return !client.open(); }));
  }
  EXPECT_EQ(server_->clients(), 0U);
  EXPECT_EQ(server_->counters().connections_refused, wrong.size());
  for (const char* protocol : {"", "something.else"}) {
    ViewClient client(server_->port());
    client.upgrade("/ws", protocol);
    EXPECT_EQ(head(client).substr(8, 4), " 400") << protocol;
    EXPECT_TRUE(serve_until(client, [&] { return !client.open(); })) << protocol;
    EXPECT_NE(client.input.find("swarmflow.view.v1"), std::string::npos) << client.input;
  }
}

TEST_F(ViewServerTest, AnswersHeadWithoutABody) {
  start();
  const std::string whole = get("/metrics");
  const std::string head_only = get("/metrics", "HEAD");
  EXPECT_TRUE(head_only.starts_with("HTTP/1.1 200")) << head_only;
  EXPECT_TRUE(head_only.ends_with("\r\n\r\n")) << head_only;
  EXPECT_NE(head_only.find("content-length: "), std::string::npos);
  EXPECT_TRUE(get("/nothing", "HEAD").starts_with("HTTP/1.1 404"));
  EXPECT_TRUE(get("/nothing", "HEAD").ends_with("\r\n\r\n"));
  EXPECT_FALSE(whole.ends_with("\r\n\r\n"));
}

TEST_F(ViewServerTest, AnswersOldAndIncompleteRequests) {
  start();
  ViewClient old(server_->port());
  old.send("GET /metrics HTTP/1.0\r\n\r\n");
  EXPECT_NE(head(old).find(" 200"), std::string::npos);
  EXPECT_TRUE(serve_until(old, [&] { return !old.open(); })) << "HTTP/1.0 ends with the answer";
  ViewClient nameless(server_->port());
  nameless.send("GET /metrics HTTP/1.1\r\n\r\n");
  EXPECT_TRUE(head(nameless).starts_with("HTTP/1.1 400")) << "RFC 9112 demands Host";
  ViewClient newer(server_->port());
  newer.send(
      "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade, HTTP2-Settings\r\n"
      "Upgrade: h2c\r\nHTTP2-Settings: AAMAAABkAARAAAAAAAIAAAAA\r\n\r\n");
  EXPECT_EQ(head(newer).substr(8, 4), " 400");
}

TEST_F(ViewServerTest, ServesFoxgloveUnderBothNamesAtAnyPathToAnyOrigin) {
  start();
  for (const char* protocol : {"foxglove.sdk.v1", "foxglove.websocket.v1"}) {
    ViewClient client(server_->port());
    client.upgrade("/any", protocol, "Origin: https://app.foxglove.dev\r\n");
    const std::string answer = head(client);
    ASSERT_TRUE(answer.starts_with("HTTP/1.1 101")) << answer;
    EXPECT_NE(answer.find(protocol), std::string::npos);
    EXPECT_NE(text(client, "serverInfo"), "");
    EXPECT_NE(text(client, "advertise"), "");
    client.send_text(
        R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":0},{"id":9,"channelId":3}]})");
    const std::string poses = binary(client, '\1');
    ASSERT_GT(poses.size(), 17U);
    EXPECT_EQ(poses.substr(1, 4), std::string("\7\0\0\0", 4));
    EXPECT_EQ(poses.substr(13, 4), std::string("\0\1\0\0", 4));
    EXPECT_EQ(binary(client, '\2').size(), 9U);
    // Control belongs to the page's protocol; here it has no effect.
    client.send_text(R"({"op":"control","token":"","action":"stop"})");
    EXPECT_NE(text(client, "status"), "");
  }
}

TEST_F(ViewServerTest, HandsRawSamplesOnAsTheyAre) {
  start();
  ViewClient client(server_->port());
  client.upgrade("/", "foxglove.sdk.v1");
  ASSERT_TRUE(upgraded(client));
  ASSERT_NE(text(client, "advertise"), "");
  client.send_text(R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":3}]})");
  source_.publish(0, std::string("\0\1\0\0plan", 8));
  EXPECT_EQ(binary(client, '\1'), std::string("\1\x09\0\0\0\x4D\0\0\0\0\0\0\0\0\1\0\0plan", 21));
}

TEST_F(ViewServerTest, DoesWithoutASlowClient) {
  source_.robots = 100'000;  // a picture of 1.6 MB
  start();
  ViewClient slow(server_->port(), 4096);
  slow.upgrade("/ws", "swarmflow.view.v1");
  ASSERT_TRUE(upgraded(slow));
  ViewClient fast(server_->port());
  fast.upgrade("/ws", "swarmflow.view.v1");
  ASSERT_TRUE(upgraded(fast));
  std::size_t got = 0;
  for (int i = 0; i < 30; ++i) {
    slow.send_text(R"({"op":"frame"})");  // and never reads
    fast.send_text(R"({"op":"frame"})");
    if (!binary(fast, 'S').empty()) ++got;
  }
  EXPECT_EQ(got, 30U);
  EXPECT_LE(server_->counters().view_frames_sent, 30U + 4U) << "one is under way, and some fit";
}

TEST_F(ViewServerTest, IsControlledWithTheTokenAlone) {
  std::vector<ControlAction> done;
  const Control control = [&](const ControlRequest& request) -> Result<std::string> {
    done.push_back(request.action);
    return "as requested";
  };
  const auto answer = [&](const ViewServerOptions& options, const std::string& token) {
    start(options);
    ViewClient client(server_->port());
    client.upgrade("/ws", "swarmflow.view.v1");
    EXPECT_TRUE(upgraded(client));
    client.send_text(R"({"op":"control","action":"pause","token":")" + token + "\"}");
    std::string op;
    while (const auto got = message(client)) {
      op = nlohmann::json::parse(got->payload)["op"];
      if (op == "done" || op == "refused") break;
    }
    return op;
  };
  EXPECT_EQ(answer({.control = control}, ""), "refused");
  EXPECT_EQ(answer({.token = "secret", .control = control}, "secret"), "refused");
  EXPECT_EQ(answer({.allow_control = true, .token = "secret", .control = control}, "secret1"),
            "refused");
  EXPECT_EQ(answer({.allow_control = true, .token = "secret", .control = control}, ""), "refused");
  EXPECT_TRUE(done.empty());
  EXPECT_EQ(answer({.allow_control = true, .token = "secret", .control = control}, "secret"),
            "done");
  EXPECT_EQ(done, std::vector{ControlAction::kPause});
  EXPECT_FALSE(ViewServer::make({.allow_control = true, .control = control}, source_).has_value());
}

TEST_F(ViewServerTest, CountsNonsenseAndHangsUp) {
  start();
  ViewClient client(server_->port());
  client.upgrade("/ws", "swarmflow.view.v1");
  ASSERT_TRUE(upgraded(client));
  client.send_text(std::string(5000, ' '));
  client.send_text(std::string(4001, '['));
  client.send(ViewClient::frame("binary", 2));
  client.send_text(R"({"op":"frame"})");
  EXPECT_NE(binary(client, 'S'), "") << "three are forgiven";
  EXPECT_EQ(server_->counters().frames_refused, 3U);
  for (int i = 0; i < 17; ++i) client.send_text("nonsense");
  std::string closed;
  while (const auto got = message(client)) {
    if (got->opcode == 8) closed = got->payload.substr(0, 2);
    if (!closed.empty()) break;
  }
  EXPECT_EQ(closed, "\x03\xF0") << "1008";
  client.send(ViewClient::frame(closed, 8));
  EXPECT_TRUE(serve_until(client, [&] { return server_->clients() == 0; }));
}

TEST_F(ViewServerTest, TakesSixtyFourConnections) {
  start();
  std::vector<std::unique_ptr<ViewClient>> clients;
  for (std::size_t i = 0; i < ViewServer::kMaxConnections; ++i) {
    clients.push_back(std::make_unique<ViewClient>(server_->port()));
    clients.back()->upgrade("/ws", "swarmflow.view.v1");
    ASSERT_TRUE(upgraded(*clients.back())) << i;
  }
  ViewClient one_more(server_->port());
  EXPECT_TRUE(serve_until(one_more, [&] { return !one_more.open(); }));
  EXPECT_EQ(server_->clients(), ViewServer::kMaxConnections);
  clients.pop_back();
  ViewClient next(server_->port());
  serve_until(next, [&] { return server_->clients() < ViewServer::kMaxConnections; });
  ViewClient after(server_->port());
  after.upgrade("/ws", "swarmflow.view.v1");
  EXPECT_TRUE(upgraded(after));
}

TEST_F(ViewServerTest, ReportsWhenItCannotListen) {
  start();
  const auto second = ViewServer::make({.port = server_->port()}, source_);
  ASSERT_FALSE(second.has_value());
  EXPECT_NE(second.error().message.find("Address already in use"), std::string::npos);
  EXPECT_FALSE(ViewServer::make({.address = "192.0.2.1"}, source_).has_value());
  EXPECT_FALSE(ViewServer::make({.address = "nowhere"}, source_).has_value());
}

TEST(OriginCheck, KnowsWhoServedThePage) {
  EXPECT_TRUE(same_origin("http://localhost:8080", "LOCALHOST:8080"));
  EXPECT_TRUE(same_origin("", "anything"));
  EXPECT_FALSE(same_origin("http://localhost", "localhost:8080"));
  EXPECT_FALSE(same_origin("file://", "localhost"));
  const std::vector<std::string> names = {"robotlab"};
  for (const char* host : {"127.0.0.1:80", "10.0.0.7", "[::1]:80", "localhost:1", "robotlab:80"}) {
    EXPECT_TRUE(trusted_host(host, names)) << host;
  }
  for (const char* host : {"", "evil.example:80", "127.0.0.1.evil.example", "[evil]:80"}) {
    EXPECT_FALSE(trusted_host(host, names)) << host;
  }
}

TEST(OriginCheck, ComparesTokens) {
  EXPECT_TRUE(same_token("abc", "abc"));
  EXPECT_FALSE(same_token("abd", "abc"));
  EXPECT_FALSE(same_token("abcabc", "abc"));
  EXPECT_FALSE(same_token("", "abc"));
  EXPECT_FALSE(same_token("", ""));
  EXPECT_FALSE(same_token("abc", ""));
}

}  // namespace
}  // namespace swarm::monitor
