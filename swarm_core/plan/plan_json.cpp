// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/plan/plan_json.hpp"

#include <array>
#include <initializer_list>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace swarm {
namespace {

using Json = nlohmann::json;

// The only optional key: present when the plan breaks its own constraints.
constexpr const char* kExcess = "excess_m";

tl::unexpected<Error> refuse(const std::string& place, std::string_view what) {
  return fail(ErrorCode::kBadInput, fmt::format("plan: {} {}", place, what));
}

// Unknown keys are refused: a misspelt key would otherwise be ignored in silence.
Result<void> check_keys(const Json& object, std::initializer_list<const char*> keys,
                        const std::string& place) {
  if (!object.is_object()) return refuse(place, "must be an object");
  for (const char* key : keys) {
    if (!object.contains(key)) return refuse(place, fmt::format("lacks \"{}\"", key));
  }
  for (const auto& item : object.items()) {
    bool known = false;
    for (const char* key : keys) known = known || item.key() == key;
    if (!known) return refuse(place, fmt::format("has an unknown key \"{}\"", item.key()));
  }
  return {};
}

Result<double> number(const Json& value, const std::string& place) {
  if (!value.is_number()) return refuse(place, "must be a number");
  return value.get<double>();
}

Result<std::uint32_t> node_index(const Json& value, const std::string& place) {
  if (!value.is_number_unsigned()) return refuse(place, "must be an index");
  const auto index = value.get<std::uint64_t>();
  if (index > std::numeric_limits<std::uint32_t>::max()) return refuse(place, "is out of range");
  return static_cast<std::uint32_t>(index);
}

// A list of a known length; errors name the entry.
template <std::size_t n>
Result<std::array<double, n>> numbers(const Json& value, const std::string& place) {
  if (!value.is_array() || value.size() != n) {
    return refuse(place, fmt::format("must be an array of {} numbers", n));
  }
  std::array<double, n> out{};
  for (std::size_t i = 0; i < n; ++i) {
    const Result<double> entry = number(value[i], fmt::format("{}[{}]", place, i));
    if (!entry) return tl::unexpected(entry.error());
    out[i] = *entry;
  }
  return out;
}

// The covariance is stored as [xx, xy, yy].
Result<PlanNode> read_node(const Json& value, const std::string& place) {
  if (auto keys = check_keys(value, {"mean_m", "covariance_m2", "time_s", "mass"}, place); !keys) {
    return tl::unexpected(keys.error());
  }
  const auto mean = numbers<2>(value["mean_m"], place + ".mean_m");
  if (!mean) return tl::unexpected(mean.error());
  const auto covariance = numbers<3>(value["covariance_m2"], place + ".covariance_m2");
  if (!covariance) return tl::unexpected(covariance.error());
  const auto time_s = number(value["time_s"], place + ".time_s");
  if (!time_s) return tl::unexpected(time_s.error());
  const auto mass = number(value["mass"], place + ".mass");
  if (!mass) return tl::unexpected(mass.error());
  Mat2 matrix;
  matrix << (*covariance)[0], (*covariance)[1], (*covariance)[1], (*covariance)[2];
  const Result<Gaussian> gaussian = Gaussian::make({(*mean)[0], (*mean)[1]}, matrix);
  if (!gaussian) return refuse(place, gaussian.error().message);
  return PlanNode{*gaussian, MissionTime(*time_s), *mass};
}

Result<PlanLeg> read_leg(const Json& value, const std::string& place) {
  if (auto keys = check_keys(value, {"from", "to", "mass"}, place); !keys) {
    return tl::unexpected(keys.error());
  }
  const auto from = node_index(value["from"], place + ".from");
  if (!from) return tl::unexpected(from.error());
  const auto to = node_index(value["to"], place + ".to");
  if (!to) return tl::unexpected(to.error());
  const auto mass = number(value["mass"], place + ".mass");
  if (!mass) return tl::unexpected(mass.error());
  return PlanLeg{*from, *to, *mass};
}

// The size is checked before memory is reserved: files may come from anywhere.
template <class T>
Result<std::vector<T>> read_array(const Json& value, const std::string& place, std::size_t max_size,
                                  Result<T> (*read)(const Json&, const std::string&)) {
  if (!value.is_array()) return refuse(place, "must be an array");
  if (value.size() > max_size) {
    return refuse(place,
                  fmt::format("has {} entries, at most {} are accepted", value.size(), max_size));
  }
  std::vector<T> out;
  out.reserve(value.size());
  for (std::size_t i = 0; i < value.size(); ++i) {
    Result<T> entry = read(value[i], fmt::format("{}[{}]", place, i));
    if (!entry) return tl::unexpected(entry.error());
    out.push_back(*std::move(entry));
  }
  return out;
}

}  // namespace

std::string to_json(const FlowPlan& plan, double excess_m) {
  Json nodes = Json::array();
  for (const PlanNode& node : plan.nodes()) {
    const Vec2& mean = node.gaussian.mean_m();
    const Mat2& covariance = node.gaussian.covariance_m2();
    nodes.push_back({{"mean_m", {mean.x(), mean.y()}},
                     {"covariance_m2", {covariance(0, 0), covariance(0, 1), covariance(1, 1)}},
                     {"time_s", node.time.count()},
                     {"mass", node.mass}});
  }
  Json legs = Json::array();
  for (const PlanLeg& leg : plan.legs()) {
    legs.push_back({{"from", leg.from}, {"to", leg.to}, {"mass", leg.mass}});
  }
  Json document{{"nodes", std::move(nodes)}, {"legs", std::move(legs)}};
  if (excess_m > 0.0) document[kExcess] = excess_m;
  return document.dump(1);
}

// Each part is checked on its own first; FlowPlan::make() then checks the flow as a whole.
Result<FlowPlan> plan_from_json(std::string_view text) {
  // Parsing without exceptions reports that it failed, but not where.
  Json document = Json::parse(text, nullptr, false);
  if (document.is_object() && document.contains(kExcess) && document[kExcess].is_number()) {
    document.erase(kExcess);
  }
  if (document.is_discarded()) return fail(ErrorCode::kBadInput, "plan: not a JSON document");
  if (auto keys = check_keys(document, {"nodes", "legs"}, "document"); !keys) {
    return tl::unexpected(keys.error());
  }
  auto nodes = read_array<PlanNode>(document["nodes"], "nodes", FlowPlan::kMaxNodes, read_node);
  if (!nodes) return tl::unexpected(nodes.error());
  auto legs = read_array<PlanLeg>(document["legs"], "legs", FlowPlan::kMaxLegs, read_leg);
  if (!legs) return tl::unexpected(legs.error());
  return FlowPlan::make(*std::move(nodes), *std::move(legs));
}

double excess_from_json(std::string_view text) {
  const Json document = Json::parse(text, nullptr, false);
  const bool has = document.is_object() && document.contains(kExcess);
  return has && document[kExcess].is_number() ? document[kExcess].get<double>() : 0.0;
}

}  // namespace swarm
