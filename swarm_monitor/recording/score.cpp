// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
/// Reads a recording into what a replay publishes and when.
#include <algorithm>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "swarm_core/robot_log/reader.hpp"
#include "swarm_monitor/recording/bus_tap.hpp"
#include "swarm_monitor/recording/replay.hpp"

namespace swarm::monitor {
namespace {

/// A topic is wanted if it begins with one of the prefixes; without prefixes all are.
bool is_wanted(const std::string& topic, const std::vector<std::string>& wanted) {
  return wanted.empty() || std::any_of(wanted.begin(), wanted.end(), [&](const std::string& begin) {
           return topic.starts_with(begin);
         });
}

/// Topics whose last message stays valid: a replay that begins in the middle needs it.
bool is_latched(const std::string& topic) {
  return topic == "swarm/plan" || topic == "swarm/scene" || topic == "swarm/command";
}

}  // namespace

/// Messages in the order of their sending. A sending time that goes back (a clock that was set) is
/// raised to the latest one of its topic, so that each topic keeps the order of the file.
Result<Score> read_score(const std::filesystem::path& file, double from_s,
                         const std::vector<std::string>& topics) {
  std::map<std::string, std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < recorded_topics().size(); ++i) {
    if (is_wanted(recorded_topics()[i].name, topics)) numbers[recorded_topics()[i].name] = i;
  }
  Score score;
  std::vector<std::int64_t> sent_until(recorded_topics().size(),
                                       std::numeric_limits<std::int64_t>::min());
  const auto damage = mcap::read(
      file,
      {.message =
           [&](const mcap::Message& message, const mcap::Channel& channel, const mcap::Schema&) {
             const auto topic = numbers.find(channel.topic);
             if (topic == numbers.end()) {
               ++score.foreign;
               return;
             }
             std::int64_t& until = sent_until[topic->second];
             until = std::max(until, message.publish_time_ns);
             score.messages.push_back({.at = Duration(until),
                                       .topic = topic->second,
                                       .size = static_cast<std::uint32_t>(message.data.size()),
                                       .begin = score.bytes.size()});
             score.bytes.insert(score.bytes.end(), message.data.begin(), message.data.end());
           },
       .attachment =
           [&](const mcap::Attachment& attachment) { score.attachments.push_back(attachment); }});
  if (!damage) return tl::unexpected(damage.error());
  score.damaged = damage->damaged;
  auto& messages = score.messages;
  if (messages.empty()) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{} holds no message of the topics asked for", file.string()));
  }
  std::stable_sort(messages.begin(), messages.end(),
                   [](const auto& a, const auto& b) { return a.at < b.at; });
  const Duration begin = messages.front().at + from_seconds(from_s);
  // The last message of each latched topic before the begin moves to the begin.
  std::map<std::uint32_t, ReplayMessage> latched;
  auto first = messages.begin();
  for (; first != messages.end() && first->at < begin; ++first) {
    if (is_latched(recorded_topics()[first->topic].name)) latched[first->topic] = *first;
  }
  messages.erase(messages.begin(), first);
  for (const auto& [topic, message] : latched) {
    messages.insert(messages.begin(), message)->at = begin;
  }
  for (ReplayMessage& message : messages) message.at -= begin;
  return score;
}

}  // namespace swarm::monitor
