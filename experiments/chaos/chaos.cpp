// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/chaos.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "experiments/chaos/chaos_flight.hpp"
#include "experiments/chaos/flight_result.hpp"
#include "swarm_core/app/run_dir.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_launcher/processes/builtin_catalogue.hpp"
#include "swarm_launcher/supervision/progress.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

SteadyTime now() { return std::chrono::steady_clock::now(); }

/// The sums over all flights.
struct ChaosResult {
  std::uint32_t flights = 0, contacts = 0, lost = 0;
  std::map<std::string, std::uint32_t> faults;
  nlohmann::json failures = nlohmann::json::array();
};

nlohmann::json summary_of(const std::filesystem::path& dir) {
  const auto text = shell::read_file(dir / shell::kSummaryFile, 1U << 24U);
  return text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
}

/// Flies once and adds to the result.
Result<void> fly_once(const ChaosOptions& options, const Mission& mission,
                      const std::filesystem::path& out, ChaosResult& result) {
  const std::uint64_t seed = options.seed + result.flights;
  Rng rng(mix_seed(seed, 0xC4A05));
  const std::uint32_t robots = mission.robots.count;
  ChaosFlightSpec spec{.mission = options.mission,
                       .dir = out / fmt::format("flight-{:04}", seed),
                       .robots = robots,
                       .seed = seed,
                       .bounds_m = mission.world.bounds_m(),
                       .network = draw_network(rng)};
  spec.faults = draw_faults({.agents = robots}, rng);
  const auto injected = fly_disturbed(spec);
  if (!injected) return tl::unexpected(injected.error());
  for (const Fault& fault : *injected) ++result.faults[std::string(to_string(fault.kind))];
  const FlightVerdict verdict = judge_flight(summary_of(spec.dir), *injected);
  ++result.flights;
  result.contacts += verdict.contacts;
  result.lost += static_cast<std::uint32_t>(verdict.lost.size());
  for (const std::string& why : verdict.failures) {
    result.failures.push_back({{"seed", seed}, {"run", spec.dir.string()}, {"why", why}});
  }
  return {};
}

void print(const ChaosOptions& options, const ChaosResult& result) {
  const bool ok = result.failures.empty();
  if (options.json) {
    const nlohmann::ordered_json json = {
        {"verdict", ok ? "ok" : "broken"}, {"seed", options.seed}, {"flights", result.flights},
        {"contacts", result.contacts},     {"lost", result.lost},  {"faults", result.faults},
        {"failures", result.failures}};
    std::puts(json.dump(2).c_str());
    return;
  }
  std::string faults;
  for (const auto& [kind, count] : result.faults)
    faults += fmt::format("  {:<16} {}\n", kind, count);
  std::fputs(fmt::format("chaos            {}\nflights          {}\ncontacts         {}\n"
                         "robots killed    {}\nfaults\n{}",
                         ok ? "ok" : "promises broken", result.flights, result.contacts,
                         result.lost, faults)
                 .c_str(),
             stdout);
  for (const auto& failure : result.failures) {
    std::fputs(
        fmt::format("- {}: {} (repeat: --seed {} --minutes 0)\n", failure["run"].get<std::string>(),
                    failure["why"].get<std::string>(), failure["seed"].get<std::uint64_t>())
            .c_str(),
        stdout);
  }
}

}  // namespace

Result<ExitCode> chaos(const ChaosOptions& options) {
  const auto robots = options.robots > 0 ? std::optional(options.robots) : std::nullopt;
  const auto mission = load_mission(options.mission, builtin_catalogue(), robots);
  if (!mission) return tl::unexpected(mission.error());
  const auto out = shell::make_run_dir(options.out, "chaos-" + mission->name);
  if (!out) return tl::unexpected(out.error());
  Progress progress;
  ChaosResult result;
  const SteadyTime begin = now();
  do {
    progress.show("chaos", fmt::format("flight {}, {:.0f} of {:.0f} min, {} failures",
                                       result.flights + 1, to_seconds(now() - begin) / 60.0,
                                       options.minutes, result.failures.size()));
    if (auto flown = fly_once(options, *mission, *out, result); !flown) {
      return tl::unexpected(flown.error());
    }
  } while (to_seconds(now() - begin) < 60.0 * options.minutes && shell::stop_requests() == 0);
  print(options, result);
  return result.failures.empty() ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
}

}  // namespace swarm::launcher
