// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/scene_json.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "swarm_monitor/view/view_frame.hpp"

namespace swarm::monitor {
namespace {

/// Building blocks of the page's messages; keys and shapes are defined in PROTOCOL.md.
nlohmann::json point(const Vec2& p) { return {p.x(), p.y()}; }

/// The three different entries of the symmetric 2×2 covariance: xx, xy, yy.
nlohmann::json covariance(const Gaussian& g) {
  const Mat2& c = g.covariance_m2();
  return {c(0, 0), c(0, 1), c(1, 1)};
}

nlohmann::json mixture(const Mixture& m) {
  auto list = nlohmann::json::array();
  for (const WeightedGaussian& component : m.components()) {
    list.push_back({{"mean", point(component.gaussian.mean_m())},
                    {"cov", covariance(component.gaussian)},
                    {"weight", component.weight}});
  }
  return list;
}

nlohmann::json obstacles(const World& world) {
  auto list = nlohmann::json::array();
  for (std::size_t i = 0; i < world.obstacles().size(); ++i) {
    nlohmann::json obstacle{{"id", i}};
    if (const auto* circle = std::get_if<Circle>(&world.obstacles()[i])) {
      obstacle["circle"] = {circle->center_m.x(), circle->center_m.y(), circle->radius_m};
    } else {
      auto vertices = nlohmann::json::array();
      for (const Vec2& v : std::get<Polygon>(world.obstacles()[i]).vertices_m()) {
        vertices.push_back(point(v));
      }
      obstacle["polygon"] = std::move(vertices);
    }
    list.push_back(std::move(obstacle));
  }
  return list;
}

/// The plan as nodes and legs (from, to, mass); null while there is none.
nlohmann::json plan_of(const FlowPlan* plan) {
  if (plan == nullptr) return nullptr;
  auto nodes = nlohmann::json::array();
  for (const PlanNode& node : plan->nodes()) {
    nodes.push_back({{"mean", point(node.gaussian.mean_m())},
                     {"cov", covariance(node.gaussian)},
                     {"t", node.time.count()},
                     {"mass", node.mass}});
  }
  auto legs = nlohmann::json::array();
  for (const PlanLeg& leg : plan->legs()) legs.push_back({leg.from, leg.to, leg.mass});
  return {{"nodes", std::move(nodes)}, {"legs", std::move(legs)}};
}

/// JSON has no NaN and no infinity.
nlohmann::json finite(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace

/// A whole scene in one message, so that a page that joins late needs no earlier one.
std::string scene_json(const SceneFacts& facts) {
  const Mission& m = facts.mission;
  const Box& bounds = facts.world.bounds_m();
  return nlohmann::json{
      {"op", "scene"},
      {"t", facts.from_s},
      {"name", m.name},
      {"live", facts.live},
      {"control", facts.control},
      {"robots", m.robots.count},
      {"radius_m", m.robots.radius_m},
      {"begin", 0.0},
      {"end", facts.end_s},
      {"bounds", {point(bounds.min_m), point(bounds.max_m)}},
      {"origin", point(view_origin_m(bounds))},
      {"obstacles", obstacles(facts.world)},
      {"start", mixture(m.start)},
      {"goal", mixture(facts.goal)},
      {"plan", plan_of(facts.plan)},
      {"plan_excess_m", facts.plan_excess_m},
      {"cell_m", facts.channel == Channel::kGroups ? m.link.group_cell_size_m : m.link.cell_size_m},
      {"hearing_m", m.link.communication_radius_m}}
      .dump();
}

/// Event texts may hold any bytes; invalid UTF-8 is replaced.
std::string event_json(const RunEvent& event) {
  return nlohmann::json{{"t", event.time_s},
                        {"source", event.source},
                        {"severity", event.severity},
                        {"code", event.code},
                        {"text", event.text}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string series_json(const SeriesRow& row) {
  return nlohmann::json{row.time_s, finite(row.nearest_gap_m), row.arrived,
                        row.moving, finite(row.latency_ms),    finite(row.rate_hz)}
      .dump();
}

}  // namespace swarm::monitor
