// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "swarm_monitor/view/session.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::monitor {

/// What a client can subscribe to. Channels are numbered in their order, from 0.
struct FoxgloveChannel {
  std::string topic{};
  std::string schema_name{};
  std::string schema{};  ///< OMG IDL; the encoding is CDR
};

/// A message shared by all clients that have yet to get it.
struct FoxgloveSample {
  UtcTime stamp{};
  std::shared_ptr<const std::vector<std::byte>> bytes{};  ///< null: none
};

/// `id` is chosen by the client and names the subscription in every message to it.
struct SubscribeRequest {
  struct One {
    std::uint32_t id = 0;
    std::uint32_t channel = 0;
  };
  std::vector<One> subscriptions{};
};

/// Ids of the client's own subscriptions.
struct UnsubscribeRequest {
  std::vector<std::uint32_t> ids{};
};

/// A request of the protocol for a capability that was not announced.
struct UnsupportedRequest {
  std::string op{};
};

using FoxgloveRequest = std::variant<SubscribeRequest, UnsubscribeRequest, UnsupportedRequest>;

/// Parses a text frame of a Foxglove client; any bytes are allowed as input.
Result<FoxgloveRequest> parse_foxglove_request(std::string_view text);

/// A client of Foxglove's WebSocket protocol. It can subscribe and do nothing else.
class FoxgloveSession final : public Session {
 public:
  /// Returns the newest sample of a channel, which a new subscriber gets at once.
  using Newest = std::function<FoxgloveSample(std::uint32_t)>;

  FoxgloveSession(const std::vector<FoxgloveChannel>& channels, std::string session_id,
                  Newest newest, ViewCounters& counters)
      : Session(counters),
        channels_(channels),
        session_id_(std::move(session_id)),
        newest_(std::move(newest)) {}

  std::size_t max_frame() const override { return 64 * 1024; }
  void take(std::string_view frame, bool binary) override;
  void refuse(const std::string& why) override;
  bool has_something() const override;
  bool next(Outgoing& out) override;

  /// Whether the client subscribed to this channel.
  bool subscribed(std::uint32_t channel) const;
  /// Replaces what this client has not yet got of the channel.
  void offer(std::uint32_t channel, const FoxgloveSample& sample);
  /// The client gets the time before its next sample; only the newest time waits.
  void send_time(UtcTime now) { time_ = now; }

 private:
  // A subscription with the newest sample that the client has not got yet.
  struct Subscription {
    std::uint32_t id = 0;
    std::uint32_t channel = 0;
    FoxgloveSample pending{};
  };

  void subscribe(const SubscribeRequest& request);
  void unsubscribe(const UnsubscribeRequest& request);
  void status(int level, const std::string& message);
  void advertise(Outgoing& out);
  bool next_sample(Outgoing& out);

  const std::vector<FoxgloveChannel>& channels_;
  std::string session_id_;
  Newest newest_;
  bool greeted_ = false;              // serverInfo was sent
  std::size_t advertised_ = 0;        // channels so far
  std::deque<std::string> statuses_;  // bounded
  std::optional<UtcTime> time_;       // to be sent
  std::vector<Subscription> subscriptions_;
  std::size_t turn_ = 0;  // no channel waits for ever behind another
};

}  // namespace swarm::monitor
