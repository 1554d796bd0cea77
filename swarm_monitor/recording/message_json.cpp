// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/recording/message_json.hpp"

#include <algorithm>
#include <span>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/topics.hpp"

namespace swarm::monitor {
namespace {

using Json = nlohmann::ordered_json;

/// 64-bit integers become texts: JSON readers that use doubles lose integers beyond 2⁵³.
std::string text(std::int64_t value) { return fmt::format("{}", value); }
std::string text(std::uint64_t value) { return fmt::format("{}", value); }
std::string text(UtcTime time) { return text(time.time_since_epoch().count()); }

/// JSON of a field, chosen by its type alone: messages list their fields, so a new message needs no
/// code here.
template <class T>
Json json_of(const T& value) {
  if constexpr (link::Message<T>) {
    Json object = Json::object();
    link::for_each_field<T>(
        [&](auto field) { object[std::string(field.kName)] = json_of(value.*(field.kMember)); });
    return object;
  } else if constexpr (link::kIsSequence<T>) {
    Json array = Json::array();
    for (const auto& element : value) array.push_back(json_of(element));
    return array;
  } else if constexpr (std::is_enum_v<T>) {
    return static_cast<int>(value);
  } else if constexpr (std::is_integral_v<T> && sizeof(T) == sizeof(std::int64_t)) {
    return text(value);
  } else {
    return value;
  }
}

/// Records of robot logs have structs of their own, hence a function for each; the names are those
/// of the IDL.
Json json_of(RobotId robot, const robot_log::Header& r) {
  return {{"stamp_utc_ns", text(r.stamp)},
          {"robot_id", robot.value()},
          {"robots", r.robots},
          {"process_id", r.process_id},
          {"radius_m", r.radius_m}};
}

Json json_of(RobotId robot, const robot_log::Step& r) {
  return {{"stamp_utc_ns", text(r.stamp)},
          {"robot_id", robot.value()},
          {"lateness_us", r.lateness_us},
          {"x_m", r.position_m.x()},
          {"y_m", r.position_m.y()},
          {"vx_mps", r.velocity_mps.x()},
          {"vy_mps", r.velocity_mps.y()},
          {"mode", r.mode},
          {"goal", r.goal},
          {"neighbours", r.neighbours},
          {"plan_version", r.plan_version},
          {"plan_time_s", r.plan_time_s},
          {"reference_x_m", r.reference_x_m},
          {"reference_y_m", r.reference_y_m}};
}

Json json_of(RobotId robot, const robot_log::Estimate& r) {
  return {{"stamp_utc_ns", text(r.stamp)},
          {"robot_id", robot.value()},
          {"neighbour_id", r.neighbour.value()},
          {"x_m", r.position_m.x()},
          {"y_m", r.position_m.y()}};
}

Json json_of(RobotId robot, const robot_log::LinkStats& r) {
  Json bins = Json::array();
  for (std::size_t i = 0; i < Histogram::kBins; ++i) {
    if (r.state_age.bin(i) > 0) bins.push_back({{"bin", i}, {"count", text(r.state_age.bin(i))}});
  }
  return {{"stamp_utc_ns", text(r.stamp)}, {"robot_id", robot.value()},
          {"states_sent", r.states_sent},  {"states_received", r.states_received},
          {"refused", r.refused},          {"state_age", std::move(bins)}};
}

Json json_of(RobotId robot, const robot_log::Note& r) {
  return {{"stamp_utc_ns", text(r.stamp)},
          {"caused_utc_ns", text(r.caused)},
          {"robot_id", robot.value()},
          {"code", r.code},
          {"text", r.text}};
}

/// The fields of a sample if it is an M, null if it does not decode.
template <class M>
bool put_fields(const std::string& type, std::span<const unsigned char> data, Json& out) {
  if (type != link::type_name<M>()) return false;
  M message;
  if (link::decode(std::as_bytes(data), message)) out = json_of(message);
  return true;
}

template <class... M>
Json fields_of(link::MessageList<M...>, const std::string& type,
               std::span<const unsigned char> data) {
  Json fields(nullptr);
  (void)(put_fields<M>(type, data, fields) || ...);
  return fields;
}

/// Robot log records first, then messages of the bus by type name.
Json data_of(const mcap::Message& message, const mcap::Channel& channel, const std::string& type) {
  if (const auto record = robot_log::decode(message, channel)) {
    return std::visit([&](const auto& r) { return json_of(record->robot, r); }, record->record);
  }
  return fields_of(link::AllMessages(), type, message.data);
}

}  // namespace

Result<PrintedMessages> print_messages(const std::filesystem::path& file,
                                       const std::vector<std::string>& topics,
                                       const std::function<bool(const std::string&)>& print) {
  PrintedMessages result;
  const auto wanted = [&](const std::string& topic) {
    return topics.empty() || std::any_of(topics.begin(), topics.end(), [&](const auto& begin) {
             return topic.starts_with(begin);
           });
  };
  bool wanted_more = true;
  const auto damage = mcap::read(
      file, {.message =
                 [&](const mcap::Message& message, const mcap::Channel& channel,
                     const mcap::Schema& schema) {
                   result.topics.insert(channel.topic);
                   if (!wanted_more || !wanted(channel.topic)) return;
                   ++result.printed;
                   wanted_more = print(Json{{"topic", channel.topic},
                                            {"type", schema.name},
                                            {"log_time_ns", text(message.log_time_ns)},
                                            {"publish_time_ns", text(message.publish_time_ns)},
                                            {"sequence", message.sequence},
                                            {"data", data_of(message, channel, schema.name)}}
                                           .dump(-1, ' ', false, Json::error_handler_t::replace));
                 },
             .go_on = [&] { return wanted_more; }});
  if (!damage) return tl::unexpected(damage.error());
  result.damage = *damage;
  return result;
}

}  // namespace swarm::monitor
