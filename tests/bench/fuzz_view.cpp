// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Throws hostile frames at the live view's server: fuzz_view [frames] [seed]. Counted are the
// frames that reach a session, not those behind a broken one. To be run with sanitizers. Prints
// how much memory it took, and ends with 0 if the server still serves a well-behaved client.
#include <array>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>

#include "swarm_monitor/view/view_server.hpp"
#include "tests/unit/swarm_monitor/fake_view_source.hpp"
#include "tests/unit/swarm_monitor/frame_mutator.hpp"
#include "tests/unit/swarm_monitor/view_client.hpp"

namespace {

using swarm::monitor::FakeViewSource;
using swarm::monitor::FrameMutator;
using swarm::monitor::ViewClient;
using swarm::monitor::ViewServer;

constexpr std::size_t kClients = 40;

const std::vector<std::string> kPageValid = {
    R"({"op":"frame"})",
    R"({"op":"frame","t":12.5})",
    R"({"op":"focus","robot":17})",
    R"({"op":"focus","robot":null})",
    R"({"op":"control","token":"secret","action":"pause"})",
    R"({"op":"control","token":"secret","action":"goal","x":1,"y":2})",
    R"({"op":"control","token":"secret","action":"add_obstacle","x":1,"y":2,"radius":3})"};

const std::vector<std::string> kFoxgloveValid = {
    R"({"op":"unsubscribe","subscriptionIds":[2]})",
    R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":3}]})",
    R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]})",
    R"({"op":"subscribe","subscriptions":[{"id":3,"channelId":1}]})",
    R"({"op":"unsubscribe","subscriptionIds":[1]})",
    R"({"op":"advertise","channels":[{"id":1,"topic":"a","encoding":"json","schemaName":"b"}]})",
    R"({"op":"getParameters","parameterNames":["a"]})"};

const std::vector<std::string> kPaths = {"/",
                                         "/metrics",
                                         "/ws",
                                         "/dygraph.min.js",
                                         "/../../etc/passwd",
                                         "/%2e%2e/%2e%2e/etc/passwd",
                                         "/..%5c..%5cetc",
                                         "//",
                                         "/?x=%00&y=%ff",
                                         "/%",
                                         "http://evil.example/",
                                         "*",
                                         "/\xFF\xFE"};

struct Counts {
  std::uint64_t frames = 0;
  std::uint64_t garbage = 0;
  std::uint64_t requests = 0;
  std::uint64_t connections = 0;
};

class Attack {
 public:
  Attack(ViewServer& server, std::uint64_t seed)
      : server_(server),
        page_(seed, kPageValid),
        foxglove_(seed + 1, kFoxgloveValid),
        clients_(kClients) {}

  /// One action of a random client.
  void strike() {
    const std::size_t which = mutator_.below(clients_.size());
    const bool page = which < clients_.size() / 2;
    auto& client = clients_[which];
    if (client) client->read();
    if (!client || !client->open()) return connect(client, page);
    if (mutator_.chance(0.01) || given_up(*client)) return client.reset();  // without a close frame
    if (mutator_.chance(0.3)) client->input.clear();
    if (mutator_.chance(0.01)) {
      ++counts.garbage;
      client->send(mutator_.garbage(mutator_.below(500)));
    } else {
      volley(*client, page);
    }
  }

  Counts counts{};

 private:
  void connect(std::unique_ptr<ViewClient>& client, bool page) {
    ++counts.connections;
    client = std::make_unique<ViewClient>(server_.port(), mutator_.chance(0.2) ? 4096 : 0);
    static const std::array<const char*, 6> kProtocols = {
        "swarmflow.view.v1", "foxglove.sdk.v1", "foxglove.websocket.v1", "nothing", "", ",;\"\x01"};
    const double dice = static_cast<double>(mutator_.below(1000)) / 1000.0;
    if (dice < 0.1) {
      ++counts.requests;
      client->send(request());
    } else if (dice < 0.12) {
      ++counts.garbage;
      client->send(mutator_.garbage(mutator_.below(5000)));
    } else if (dice < 0.15) {
      client->upgrade(kPaths[mutator_.below(kPaths.size())],
                      kProtocols[mutator_.below(kProtocols.size())],
                      "Origin: " + mutator_.next() + "\r\n");
    } else {
      client->upgrade("/ws", kProtocols[page ? 0 : 1 + mutator_.below(2)]);
    }
  }

  /// Whether the server has closed the connection: close frame, code 1008.
  static bool given_up(const ViewClient& client) {
    return client.input.find("\x88\x02\x03\xF0") != std::string::npos;
  }

  std::string request() {
    static const std::array<const char*, 6> kMethods = {"GET", "POST",    "HEAD",
                                                        "PUT", "OPTIONS", "\x01"};
    std::string path = kPaths[mutator_.below(kPaths.size())];
    if (mutator_.chance(0.3)) path += mutator_.garbage(mutator_.below(40));
    if (mutator_.chance(0.05)) path += std::string(mutator_.below(9000), 'a');
    std::string text =
        fmt::format("{} {} HTTP/1.1\r\nHost: localhost\r\n",
                    mutator_.chance(0.7) ? "GET" : kMethods[mutator_.below(6)], path);
    if (mutator_.chance(0.2)) text += "Content-Length: 99999999999999999999\r\n";
    if (mutator_.chance(0.2)) text += "Range: bytes=-1-\r\nConnection: upgrade\r\nUpgrade: h2c\r\n";
    if (mutator_.chance(0.1)) text += mutator_.garbage(100);
    text += "\r\n";
    if (mutator_.chance(0.2)) text.resize(mutator_.below(text.size()));
    return mutator_.chance(0.2) ? text + text : text;
  }

  void volley(ViewClient& client, bool page) {
    std::string bytes;
    for (std::size_t n = 1 + mutator_.below(20); n > 0; --n, ++counts.frames) bytes += frame(page);
    client.send(bytes);
  }

  std::string frame(bool page) {
    const std::vector<std::string>& valid = page ? kPageValid : kFoxgloveValid;
    std::string payload = mutator_.chance(0.7) ? valid[mutator_.below(valid.size())]
                          : page               ? page_.next()
                                               : foxglove_.next();
    if (mutator_.chance(0.002)) payload.resize(mutator_.below(80'000), ' ');
    const bool wild = mutator_.chance(0.004);
    std::string bytes = ViewClient::frame(
        payload, wild ? static_cast<unsigned>(mutator_.below(128)) : 1U, !mutator_.chance(0.001));
    if (mutator_.chance(0.001)) bytes[1] = static_cast<char>(bytes[1] & 0x7F);  // not masked
    if (mutator_.chance(0.001)) bytes[mutator_.below(bytes.size())] ^= 0x10;
    if (mutator_.chance(0.001)) bytes.resize(mutator_.below(bytes.size()));
    if (mutator_.chance(0.0001)) bytes.replace(1, 1, "\xFF\x7F\xFF\xFF\xFF\xFF\xFF\xFF\xFF", 9);
    return bytes;
  }

  ViewServer& server_;
  FrameMutator page_;
  FrameMutator foxglove_;
  FrameMutator& mutator_ = page_;                     // for all other random choices
  std::vector<std::unique_ptr<ViewClient>> clients_;  // the first half uses the page's protocol
};

/// A client that only wants to see a frame.
bool still_serves(ViewServer& server) {
  ViewClient client(server.port());
  client.upgrade("/ws", "swarmflow.view.v1");
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  bool upgraded = false;
  while (std::chrono::steady_clock::now() < end && client.open()) {
    server.serve(std::chrono::milliseconds(1));
    client.read();
    if (const std::size_t head = client.input.find("\r\n\r\n");
        !upgraded && head != std::string::npos) {
      upgraded = client.input.starts_with("HTTP/1.1 101");
      if (!upgraded) return false;
      client.input.erase(0, head + 4);
      client.send_text(kPageValid[0]);
    }
    while (upgraded) {
      const auto message = client.message();
      if (!message) break;
      if (message->opcode == 2) return true;
    }
  }
  return false;
}

long peak_MiB() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t frames = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1'000'000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  FakeViewSource source;
  source.robots = 300;
  std::uint64_t controls = 0;
  auto server = ViewServer::make({.allow_control = true,
                                  .token = "secret",
                                  .control =
                                      [&](const swarm::monitor::ControlRequest&) {
                                        ++controls;
                                        return swarm::Result<std::string>("done");
                                      }},
                                 source);
  if (!server) {
    fmt::print(stderr, "{}\n", server.error().message);
    return 2;
  }
  Attack attack(**server, seed);
  long early_MiB = 0;
  const auto& counters = (*server)->counters();
  while (counters.frames_received < frames) {
    for (int i = 0; i < 8; ++i) attack.strike();
    source.publish(0, "sample");
    (*server)->serve(swarm::Duration(0));
    if (early_MiB == 0 && counters.frames_received > frames / 10) early_MiB = peak_MiB();
  }
  const bool alive = still_serves(**server);
  fmt::print(
      "{} frames ({} reached a session), {} heaps of garbage, {} HTTP requests, {} "
      "connections\n",
      attack.counts.frames, counters.frames_received, attack.counts.garbage, attack.counts.requests,
      attack.counts.connections);
  fmt::print(
      "{} pictures sent, {} controls done, {} frames refused, {} samples skipped, {} "
      "connections refused\n",
      counters.view_frames_sent, controls, counters.frames_refused, counters.samples_skipped,
      counters.connections_refused);
  fmt::print("peak {} MiB after a tenth, {} MiB at the end; {}\n", early_MiB, peak_MiB(),
             alive ? "still serves" : "SERVES NO MORE");
  return alive ? 0 : 1;
}
