// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/foxglove_feed.hpp"

#include <algorithm>
#include <utility>

#include "swarm_monitor/view/foxglove_messages.hpp"
#include "swarm_monitor/view/foxglove_schemas.hpp"

namespace swarm::monitor {
namespace {

/// Channels of Foxglove's own schemas; the raw channels of the source follow them. Frames are made
/// ten times a second.
constexpr std::uint32_t kRobots = 0;
constexpr std::uint32_t kObstacles = 1;
constexpr std::uint32_t kMixture = 2;
constexpr std::uint32_t kOwnChannels = 3;
constexpr Duration kViewFramePeriod = std::chrono::milliseconds(100);

/// Whether any client subscribed to the channel: other messages are not built.
bool wanted(std::span<FoxgloveSession* const> sessions, std::uint32_t channel) {
  return std::any_of(sessions.begin(), sessions.end(),
                     [&](const FoxgloveSession* s) { return s->subscribed(channel); });
}

}  // namespace

FoxgloveFeed::FoxgloveFeed(ViewSource& source) : source_(source) {
  channels_ = {{"/robots", "foxglove::PosesInFrame", std::string(foxglove::kPosesInFrameIdl)},
               {"/obstacles", "foxglove::SceneUpdate", std::string(foxglove::kSceneUpdateIdl)},
               {"/mixture", "foxglove::SceneUpdate", std::string(foxglove::kSceneUpdateIdl)}};
  take_channels();
  source_.on_raw([this](const RawSample& sample) { take_raw(sample); });
}

FoxgloveFeed::~FoxgloveFeed() { source_.on_raw(nullptr); }

FoxgloveSample FoxgloveFeed::newest(std::uint32_t channel) const {
  return channel < newest_.size() ? newest_[channel] : FoxgloveSample{};
}

/// Builds robots and mixture at most every 100 ms and only if subscribed, then offers every new
/// sample to all sessions.
void FoxgloveFeed::step(UtcTime now, std::span<FoxgloveSession* const> sessions) {
  take_channels();
  // A recording is shown at the time of its own samples.
  const UtcTime shown = source_.live() ? now : raw_time_.value_or(now);
  take_obstacles(shown);
  if (!sessions.empty() && (now >= next_view_frame_ || now + kViewFramePeriod < next_view_frame_)) {
    next_view_frame_ = now + kViewFramePeriod;
    take_view_frame(shown, wanted(sessions, kRobots), wanted(sessions, kMixture));
    for (FoxgloveSession* session : sessions) session->send_time(shown);
  }
  for (std::uint32_t channel = 0; channel < fresh_.size(); ++channel) {
    if (!fresh_[channel]) continue;
    fresh_[channel] = false;
    for (FoxgloveSession* session : sessions) session->offer(channel, newest_[channel]);
  }
}

void FoxgloveFeed::take_raw(const RawSample& sample) {
  take_channels();
  if (sample.channel >= raw_known_) return;
  raw_time_ = std::max(raw_time_.value_or(sample.stamp), sample.stamp);
  set(kOwnChannels + sample.channel, sample.stamp, {sample.bytes.begin(), sample.bytes.end()});
}

/// Adopts channels that the source added since the last call.
void FoxgloveFeed::take_channels() {
  const auto& raw = source_.raw_channels();
  for (; raw_known_ < raw.size(); ++raw_known_) {
    channels_.push_back({raw[raw_known_].topic, raw[raw_known_].type, raw[raw_known_].schema});
  }
  newest_.resize(channels_.size());
  fresh_.resize(channels_.size());
}

/// Obstacles change rarely, so they are sent when the source has a new scene.
void FoxgloveFeed::take_obstacles(UtcTime now) {
  const auto& scenes = source_.scenes();
  if (scenes.size() <= scenes_seen_) return;
  scenes_seen_ = scenes.size();
  auto update = foxglove::obstacles_scene(now, scenes.back());
  set(kObstacles, now, std::move(update));
}

void FoxgloveFeed::take_view_frame(UtcTime now, bool robots, bool mixture) {
  if (!robots && !mixture) return;
  source_.view_frame(std::nullopt, std::nullopt, view_frame_);
  const auto view_frame = read_view_frame(view_frame_, source_.origin_m());
  if (!view_frame) return;
  if (robots) set(kRobots, now, foxglove::poses_in_frame(now, *view_frame));
  if (mixture) set(kMixture, now, foxglove::mixture_scene(now, *view_frame));
}

void FoxgloveFeed::set(std::uint32_t channel, UtcTime stamp, std::vector<std::byte> bytes) {
  newest_[channel] = {stamp, std::make_shared<const std::vector<std::byte>>(std::move(bytes))};
  fresh_[channel] = true;
}

}  // namespace swarm::monitor
