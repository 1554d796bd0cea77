// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Reads a recording as what a replay says.
#include <algorithm>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "swarm_core/robot_log/reader.hpp"
#include "swarm_monitor/recording/bus_tap.hpp"
#include "swarm_monitor/recording/replay.hpp"

namespace swarm::monitor {
namespace {

bool is_wanted(const std::string& topic, const std::vector<std::string>& wanted) {
  return wanted.empty() || std::any_of(wanted.begin(), wanted.end(), [&](const std::string& begin) {
           return topic.starts_with(begin);
         });
}

bool is_latched(const std::string& topic) {
  return topic == "swarm/plan" || topic == "swarm/scene" || topic == "swarm/command";
}

}  // namespace

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
