// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/foxglove_session.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_monitor/view/cdr_writer.hpp"

namespace swarm::monitor {
namespace {

using Json = nlohmann::json;

/// Opcodes and status levels of Foxglove's protocol; number of status texts that a slow client
/// keeps waiting.
constexpr std::uint8_t kMessageData = 0x01;
constexpr std::uint8_t kTime = 0x02;
constexpr int kWarning = 1;
constexpr int kError = 2;
constexpr std::size_t kMaxStatuses = 16;

/// Requests of the protocol for capabilities that this server does not announce: answered by a
/// warning, not counted as malformed.
constexpr std::array<std::string_view, 10> kUnsupported = {"advertise",
                                                           "unadvertise",
                                                           "getParameters",
                                                           "setParameters",
                                                           "subscribeParameterUpdates",
                                                           "unsubscribeParameterUpdates",
                                                           "subscribeConnectionGraph",
                                                           "unsubscribeConnectionGraph",
                                                           "fetchAsset",
                                                           "playbackControlRequest"};

tl::unexpected<Error> bad(std::string message) {
  return fail(ErrorCode::kBadInput, std::move(message));
}

/// Invalid UTF-8 in texts is replaced, so that dump() cannot throw.
std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// A 32-bit identifier; empty for anything else, negative numbers and fractions included.
std::optional<std::uint32_t> id_of(const Json& json) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > 0xFFFFFFFFU) return std::nullopt;
  return json.get<std::uint32_t>();
}

Result<FoxgloveRequest> parse_subscribe(const Json& json) {
  const auto list = json.find("subscriptions");
  if (list == json.end() || !list->is_array()) return bad("subscriptions must be an array");
  SubscribeRequest request;
  for (const Json& one : *list) {
    if (!one.is_object() || !one.contains("id") || !one.contains("channelId")) {
      return bad("a subscription has an id and a channelId");
    }
    const auto id = id_of(one["id"]);
    const auto channel = id_of(one["channelId"]);
    if (!id || !channel) return bad("id and channelId must be 32-bit numbers");
    request.subscriptions.push_back({*id, *channel});
  }
  return request;
}

Result<FoxgloveRequest> parse_unsubscribe(const Json& json) {
  const auto list = json.find("subscriptionIds");
  if (list == json.end() || !list->is_array()) return bad("subscriptionIds must be an array");
  UnsubscribeRequest request;
  for (const Json& one : *list) {
    const auto id = id_of(one);
    if (!id) return bad("subscriptionIds must be 32-bit numbers");
    request.ids.push_back(*id);
  }
  return request;
}

std::uint64_t ns_of(UtcTime time) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(time.time_since_epoch().count(), 0));
}

}  // namespace

Result<FoxgloveRequest> parse_foxglove_request(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return bad("not a JSON object");
  const auto at = json.find("op");
  if (at == json.end() || !at->is_string()) return bad("op must be a text");
  const auto op = at->get<std::string>();
  if (op == "subscribe") return parse_subscribe(json);
  if (op == "unsubscribe") return parse_unsubscribe(json);
  if (std::find(kUnsupported.begin(), kUnsupported.end(), op) != kUnsupported.end()) {
    return UnsupportedRequest{op};
  }
  return bad("unknown op");
}

/// Requests come from any web page that connects: every malformed one is counted, and the server
/// closes the connection after too many.
void FoxgloveSession::take(std::string_view frame, bool binary) {
  if (binary) return refuse("this server takes no messages and has no services");
  const auto request = parse_foxglove_request(frame);
  if (!request) return refuse(request.error().message);
  if (const auto* wanted = std::get_if<SubscribeRequest>(&*request)) {
    subscribe(*wanted);
  } else if (const auto* unwanted = std::get_if<UnsubscribeRequest>(&*request)) {
    unsubscribe(*unwanted);
  } else if (const auto* other = std::get_if<UnsupportedRequest>(&*request)) {
    status(kWarning, fmt::format("{} is not supported: this server only shows", other->op));
  }
}

void FoxgloveSession::refuse(const std::string& why) {
  count_refused();
  status(kError, why);
}

/// Refuses ids and channels that are taken: a client that subscribes twice would get every sample
/// twice.
void FoxgloveSession::subscribe(const SubscribeRequest& request) {
  for (const auto& one : request.subscriptions) {
    if (one.channel >= advertised_) return refuse("there is no such channel");
    const bool taken = std::any_of(
        subscriptions_.begin(), subscriptions_.end(),
        [&](const Subscription& s) { return s.id == one.id || s.channel == one.channel; });
    if (taken) return refuse("the id, or the channel, has a subscription already");
    subscriptions_.push_back(
        {.id = one.id, .channel = one.channel, .pending = newest_(one.channel)});
  }
}

void FoxgloveSession::unsubscribe(const UnsubscribeRequest& request) {
  for (const std::uint32_t id : request.ids) {
    if (std::erase_if(subscriptions_, [&](const Subscription& s) { return s.id == id; }) == 0) {
      return refuse("there is no such subscription");
    }
  }
}

void FoxgloveSession::status(int level, const std::string& message) {
  // A client that does not read its statuses loses the later ones: the queue is bounded.
  if (statuses_.size() >= kMaxStatuses) return;
  statuses_.push_back(dump({{"op", "status"}, {"level", level}, {"message", message}}));
}

bool FoxgloveSession::subscribed(std::uint32_t channel) const {
  return std::any_of(subscriptions_.begin(), subscriptions_.end(),
                     [&](const Subscription& s) { return s.channel == channel; });
}

/// The newest sample replaces one that the client has not taken yet: a slow client skips samples
/// instead of queueing them.
void FoxgloveSession::offer(std::uint32_t channel, const FoxgloveSample& sample) {
  for (Subscription& subscription : subscriptions_) {
    if (subscription.channel != channel) continue;
    if (subscription.pending.bytes) ++counters().samples_skipped;
    subscription.pending = sample;
  }
}

bool FoxgloveSession::has_something() const {
  return !greeted_ || advertised_ < channels_.size() || !statuses_.empty() || time_ ||
         std::any_of(subscriptions_.begin(), subscriptions_.end(),
                     [](const Subscription& s) { return s.pending.bytes != nullptr; });
}

/// In order: server information, channels, statuses, time, then samples. Clients need channels
/// before samples of them.
bool FoxgloveSession::next(Outgoing& out) {
  if (!std::exchange(greeted_, true)) {
    out.set_text(dump({{"op", "serverInfo"},
                       {"name", "Swarmflow"},
                       {"capabilities", {"time"}},
                       {"supportedEncodings", {"cdr"}},
                       {"sessionId", session_id_}}));
    return true;
  }
  if (advertised_ < channels_.size()) {
    advertise(out);
    return true;
  }
  if (!statuses_.empty()) {
    out.set_text(statuses_.front());
    statuses_.pop_front();
    return true;
  }
  if (time_) {
    out.binary = true;
    out.bytes.clear();
    append_raw(out.bytes, kTime);
    append_raw(out.bytes, ns_of(*std::exchange(time_, std::nullopt)));
    return true;
  }
  return next_sample(out);
}

void FoxgloveSession::advertise(Outgoing& out) {
  Json channels = Json::array();
  for (; advertised_ < channels_.size(); ++advertised_) {
    const FoxgloveChannel& channel = channels_[advertised_];
    channels.push_back({{"id", advertised_},
                        {"topic", channel.topic},
                        {"encoding", "cdr"},
                        {"schemaName", channel.schema_name},
                        {"schema", channel.schema},
                        {"schemaEncoding", "omgidl"}});
  }
  out.set_text(dump({{"op", "advertise"}, {"channels", std::move(channels)}}));
}

/// Round robin over the subscriptions, so that a fast channel does not starve the others. Binary
/// frame: opcode, subscription id, time in ns, CDR bytes.
bool FoxgloveSession::next_sample(Outgoing& out) {
  for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
    turn_ = (turn_ + 1) % subscriptions_.size();
    Subscription& subscription = subscriptions_[turn_];
    if (!subscription.pending.bytes) continue;
    const FoxgloveSample sample = std::exchange(subscription.pending, {});
    out.binary = true;
    out.bytes.clear();
    out.bytes.reserve(13 + sample.bytes->size());
    append_raw(out.bytes, kMessageData);
    append_raw(out.bytes, subscription.id);
    append_raw(out.bytes, ns_of(sample.stamp));
    append_bytes(out.bytes, sample.bytes->data(), sample.bytes->size());
    return true;
  }
  return false;
}

}  // namespace swarm::monitor
