// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/plan_clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

#include <nlohmann/json.hpp>

namespace swarm {
namespace {

/// Whether a value is an integer that T can hold; a larger one would be cut to another number.
template <class T>
bool fits(const nlohmann::json& value) {
  if (value.is_number_unsigned()) return std::in_range<T>(value.get<std::uint64_t>());
  return value.is_number_integer() && std::in_range<T>(value.get<std::int64_t>());
}

}  // namespace

std::string plan_clock_line(const PlanClock& clock) {
  const nlohmann::ordered_json json = {{"utc_ns", clock.stamp.time_since_epoch().count()},
                                       {"plan_version", clock.plan_version},
                                       {"plan_time_s", clock.plan_time_s},
                                       {"rate", clock.rate}};
  return json.dump() + "\n";
}

// Types are checked before values are read, as the JSON library would throw otherwise.
std::vector<PlanClock> read_plan_clock(std::string_view lines) {
  std::vector<PlanClock> readings;
  while (!lines.empty()) {
    const std::size_t end = std::min(lines.find('\n'), lines.size());
    const auto json = nlohmann::json::parse(lines.substr(0, end), nullptr, false);
    lines.remove_prefix(std::min(end + 1, lines.size()));
    if (!json.is_object()) continue;
    const auto stamp = json.find("utc_ns");
    const auto version = json.find("plan_version");
    const auto plan_time = json.find("plan_time_s");
    const auto rate = json.find("rate");
    if (stamp == json.end() || !fits<std::int64_t>(*stamp)) continue;
    if (version == json.end() || !fits<std::uint32_t>(*version)) continue;
    if (plan_time == json.end() || !plan_time->is_number()) continue;
    if (rate == json.end() || !rate->is_number()) continue;
    const PlanClock reading{.stamp = UtcTime(Duration(stamp->get<std::int64_t>())),
                            .plan_version = version->get<std::uint32_t>(),
                            .plan_time_s = plan_time->get<double>(),
                            .rate = rate->get<double>()};
    if (!(reading.rate >= 0.0 && reading.rate <= 1.0)) continue;
    // Stamps must ascend for the binary search in clock_at().
    if (!readings.empty() && reading.stamp < readings.back().stamp) continue;
    readings.push_back(reading);
  }
  return readings;
}

// The last reading whose stamp is not after t.
const PlanClock* clock_at(std::span<const PlanClock> readings, UtcTime t) {
  const auto after =
      std::upper_bound(readings.begin(), readings.end(), t,
                       [](UtcTime time, const PlanClock& reading) { return time < reading.stamp; });
  return after == readings.begin() ? nullptr : &*std::prev(after);
}

}  // namespace swarm
