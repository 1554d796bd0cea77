// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/recording/message_json.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/blackbox/blackbox_file.hpp"
#include "swarm_link/cdr/codec.hpp"

namespace swarm::monitor {
namespace {

using Json = nlohmann::ordered_json;

std::string text(std::int64_t value) { return fmt::format("{}", value); }
std::string text(std::uint64_t value) { return fmt::format("{}", value); }
std::string text(UtcTime time) { return text(time.time_since_epoch().count()); }

template <class T, class ToJson>
Json list(const std::vector<T>& items, ToJson to_json) {
  Json array = Json::array();
  for (const T& item : items) array.push_back(to_json(item));
  return array;
}

Json json_of(const link::PointMessage& p) { return {{"x_m", p.x_m}, {"y_m", p.y_m}}; }

Json json_of(const link::PlanMessage& m) {
  return {{"schema_version", m.schema_version},
          {"version", m.version},
          {"epoch", text(m.epoch)},
          {"scene_version", text(m.scene_version)},
          {"t0_utc_ns", text(m.t0_utc_ns)},
          {"excess_m", m.excess_m},
          {"nodes", list(m.nodes,
                         [](const link::PlanNodeMessage& n) {
                           return Json{{"mean_x_m", n.mean_x_m},
                                       {"mean_y_m", n.mean_y_m},
                                       {"covariance_xx_m2", n.covariance_xx_m2},
                                       {"covariance_xy_m2", n.covariance_xy_m2},
                                       {"covariance_yy_m2", n.covariance_yy_m2},
                                       {"time_s", n.time_s},
                                       {"mass", n.mass}};
                         })},
          {"legs",
           list(m.legs,
                [](const link::PlanLegMessage& l) {
                  return Json{{"from_node", l.from_node}, {"to_node", l.to_node}, {"mass", l.mass}};
                })},
          {"entries", list(m.entries, [](const link::PlanEntryMessage& e) {
             return Json{{"source", e.source}, {"share", e.share}};
           })}};
}

Json json_of(const link::SceneMessage& m) {
  return {{"schema_version", m.schema_version},
          {"version", text(m.version)},
          {"risk_alpha", m.risk_alpha},
          {"next_id", m.next_id},
          {"removed", m.removed},
          {"obstacles", list(m.obstacles,
                             [](const link::SceneObstacleMessage& o) {
                               return Json{{"obstacle_id", o.obstacle_id},
                                           {"owner_robot_id", o.owner_robot_id},
                                           {"vertices", o.vertices},
                                           {"center", json_of(o.center)},
                                           {"radius_m", o.radius_m},
                                           {"velocity_x_mps", o.velocity_x_mps},
                                           {"velocity_y_mps", o.velocity_y_mps},
                                           {"moving_from_utc_ns", text(o.moving_from_utc_ns)},
                                           {"moving_until_utc_ns", text(o.moving_until_utc_ns)}};
                             })},
          {"vertices", list(m.vertices, [](const link::PointMessage& p) { return json_of(p); })},
          {"goal", list(m.goal, [](const link::GoalComponentMessage& g) {
             return Json{{"mean_x_m", g.mean_x_m},
                         {"mean_y_m", g.mean_y_m},
                         {"covariance_xx_m2", g.covariance_xx_m2},
                         {"covariance_xy_m2", g.covariance_xy_m2},
                         {"covariance_yy_m2", g.covariance_yy_m2},
                         {"weight", g.weight}};
           })}};
}

Json json_of(const link::HeartbeatMessage& m) {
  return {{"schema_version", m.schema_version},
          {"phase", static_cast<int>(m.phase)},
          {"version", m.version},
          {"epoch", text(m.epoch)},
          {"sequence_number", text(m.sequence_number)},
          {"stamp_utc_ns", text(m.stamp_utc_ns)},
          {"mission_time_s", m.mission_time_s},
          {"plan_time_s", m.plan_time_s},
          {"plan_rate", m.plan_rate}};
}

Json json_of(const link::CellStatesMessage& m) {
  return {{"schema_version", m.schema_version},
          {"cell_x", m.cell_x},
          {"cell_y", m.cell_y},
          {"states", list(m.states, [](const link::RobotStateMessage& s) {
             return Json{{"robot_id", s.robot_id},
                         {"sequence_number", s.sequence_number},
                         {"stamp_utc_ns", text(s.stamp_utc_ns)},
                         {"x_m", s.x_m},
                         {"y_m", s.y_m},
                         {"vx_mps", s.vx_mps},
                         {"vy_mps", s.vy_mps},
                         {"mode", static_cast<int>(s.mode)}};
           })}};
}

Json json_of(const link::CommandMessage& m) {
  return {{"schema_version", m.schema_version},
          {"kind", static_cast<int>(m.kind)},
          {"command_id", text(m.command_id)},
          {"stamp_utc_ns", text(m.stamp_utc_ns)}};
}

Json json_of(const link::StatusMessage& m) {
  return {{"first_robot_id", m.first_robot_id},
          {"schema_version", m.schema_version},
          {"process_id", m.process_id},
          {"plan_version", m.plan_version},
          {"plan_epoch", text(m.plan_epoch)},
          {"plan_scene_version", text(m.plan_scene_version)},
          {"stamp_utc_ns", text(m.stamp_utc_ns)},
          {"plan_time_s", m.plan_time_s},
          {"robots", list(m.robots,
                          [](const link::RobotStatusMessage& r) {
                            return Json{{"robot_id", r.robot_id},
                                        {"mode", static_cast<int>(r.mode)},
                                        {"arrived", r.arrived},
                                        {"settled", r.settled},
                                        {"x_m", r.x_m},
                                        {"y_m", r.y_m},
                                        {"remaining_m", r.remaining_m},
                                        {"lag_s", r.lag_s},
                                        {"nearest_gap_m", r.nearest_gap_m},
                                        {"neighbours_heard", r.neighbours_heard},
                                        {"ticks", r.ticks},
                                        {"late_ticks", r.late_ticks},
                                        {"states_sent", r.states_sent},
                                        {"states_received", r.states_received}};
                          })},
          {"refused", m.refused},
          {"state_age", list(m.state_age, [](const link::HistogramBinMessage& b) {
             return Json{{"bin", b.bin}, {"count", b.count}};
           })}};
}

Json json_of(const link::EventMessage& m) {
  return {{"schema_version", m.schema_version},
          {"severity", static_cast<int>(m.severity)},
          {"source", m.source},
          {"stamp_utc_ns", text(m.stamp_utc_ns)},
          {"code", m.code},
          {"text", m.text}};
}

Json json_of(RobotId robot, const blackbox::Header& r) {
  return {{"stamp_utc_ns", text(r.stamp)},
          {"robot_id", robot.value()},
          {"robots", r.robots},
          {"process_id", r.process_id},
          {"radius_m", r.radius_m}};
}

Json json_of(RobotId robot, const blackbox::Step& r) {
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

Json json_of(RobotId robot, const blackbox::Belief& r) {
  return {{"stamp_utc_ns", text(r.stamp)},
          {"robot_id", robot.value()},
          {"neighbour_id", r.neighbour.value()},
          {"x_m", r.position_m.x()},
          {"y_m", r.position_m.y()}};
}

Json json_of(RobotId robot, const blackbox::LinkStats& r) {
  Json bins = Json::array();
  for (std::size_t i = 0; i < Histogram::kBins; ++i) {
    if (r.state_age.bin(i) > 0) bins.push_back({{"bin", i}, {"count", text(r.state_age.bin(i))}});
  }
  return {{"stamp_utc_ns", text(r.stamp)}, {"robot_id", robot.value()},
          {"states_sent", r.states_sent},  {"states_received", r.states_received},
          {"refused", r.refused},          {"state_age", std::move(bins)}};
}

Json json_of(RobotId robot, const blackbox::Note& r) {
  return {{"stamp_utc_ns", text(r.stamp)},
          {"caused_utc_ns", text(r.caused)},
          {"robot_id", robot.value()},
          {"code", r.code},
          {"text", r.text}};
}

template <class M>
Json decoded(std::span<const unsigned char> data) {
  static link::Codec<M> codec;  // keeps its memory
  M message;
  auto* bytes = reinterpret_cast<std::byte*>(const_cast<unsigned char*>(data.data()));
  return codec.decode({bytes, data.size()}, message) ? json_of(message) : Json(nullptr);
}

Json data_of(const mcap::Message& message, const mcap::Channel& channel, const std::string& type) {
  if (const auto record = blackbox::decode(message, channel)) {
    return std::visit([&](const auto& r) { return json_of(record->robot, r); }, record->record);
  }
  if (type == "swarm::wire::FlowPlan") return decoded<link::PlanMessage>(message.data);
  if (type == "swarm::wire::Scene") return decoded<link::SceneMessage>(message.data);
  if (type == "swarm::wire::Heartbeat") return decoded<link::HeartbeatMessage>(message.data);
  if (type == "swarm::wire::CellStates") return decoded<link::CellStatesMessage>(message.data);
  if (type == "swarm::wire::Command") return decoded<link::CommandMessage>(message.data);
  if (type == "swarm::wire::Status") return decoded<link::StatusMessage>(message.data);
  if (type == "swarm::wire::Event") return decoded<link::EventMessage>(message.data);
  return nullptr;
}

}  // namespace

Result<mcap::Damage> print_messages(const std::filesystem::path& file,
                                    const std::vector<std::string>& topics,
                                    const std::function<void(const std::string&)>& print) {
  const auto wanted = [&](const std::string& topic) {
    return topics.empty() || std::any_of(topics.begin(), topics.end(), [&](const auto& begin) {
             return topic.starts_with(begin);
           });
  };
  return mcap::read(file,
                    {.message = [&](const mcap::Message& message, const mcap::Channel& channel,
                                    const mcap::Schema& schema) {
                      if (!wanted(channel.topic)) return;
                      print(Json{{"topic", channel.topic},
                                 {"type", schema.name},
                                 {"log_time_ns", text(message.log_time_ns)},
                                 {"publish_time_ns", text(message.publish_time_ns)},
                                 {"sequence", message.sequence},
                                 {"data", data_of(message, channel, schema.name)}}
                                .dump(-1, ' ', false, Json::error_handler_t::replace));
                    }});
}

}  // namespace swarm::monitor
