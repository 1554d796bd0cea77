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

/// The sums over all flights.
struct ChaosResult {
  std::uint32_t flights = 0, contacts = 0;
  std::map<std::string, std::uint32_t> faults;
  nlohmann::ordered_json lost = nlohmann::json::array();  ///< robots, each with its cause
  nlohmann::ordered_json failures = nlohmann::json::array();
  bool interrupted = false;
};

nlohmann::json summary_of(const std::filesystem::path& dir) {
  const auto text = shell::read_file(dir / shell::kSummaryFile, 1U << 24U);
  return text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
}

/// The flight of a seed, with what this machine allows.
ChaosFlightSpec draw_flight(std::uint64_t seed, const ChaosOptions& options, const Mission& mission,
                            const ChaosMeans& means) {
  Rng rng(mix_seed(seed, 0xC4A05));
  const std::uint32_t robots = mission.robots.count;
  ChaosFlightSpec spec{.mission = options.mission,
                       .dir = {},
                       .robots = robots,
                       .seed = seed,
                       .bounds_m = mission.world.bounds_m(),
                       .setup = draw_setup(robots, rng)};
  spec.faults = draw_faults(
      {.agents = robots, .gateway = spec.setup.gateway, .two_hosts = spec.setup.two_hosts}, rng);
  spec.setup.gateway = spec.setup.gateway && means.gateways;
  return spec;
}

void add(const FlightVerdict& verdict, const ChaosFlightSpec& spec, ChaosResult& result) {
  result.contacts += verdict.contacts;
  const std::string run = spec.dir.string();
  for (const LostRobot& lost : verdict.lost) {
    result.lost.push_back({{"run", run},
                           {"robot", lost.robot},
                           {"why", lost.why.empty() ? "no fault explains it" : lost.why}});
  }
  for (const std::string& why : verdict.failures) {
    result.failures.push_back({{"seed", spec.seed}, {"run", run}, {"why", why}});
  }
}

/// Flies once and adds to the result; a flight that the user interrupts is not judged.
Result<void> fly_once(ChaosFlightSpec spec, const std::filesystem::path& out,
                      const ChaosMeans& means, ChaosResult& result) {
  spec.dir = out / fmt::format("flight-{:04}", spec.seed);
  const auto flown = fly_disturbed(spec, means);
  if (!flown) return tl::unexpected(flown.error());
  ++result.flights;
  result.interrupted = flown->interrupted;
  for (const Fault& fault : flown->injected) ++result.faults[std::string(to_string(fault.kind))];
  if (!flown->interrupted) add(judge_flight(summary_of(spec.dir), flown->injected), spec, result);
  return {};
}

void print_json(const ChaosOptions& options, const ChaosMeans& means, const ChaosResult& result) {
  const nlohmann::ordered_json json = {{"verdict", result.failures.empty() ? "ok" : "broken"},
                                       {"seed", options.seed},
                                       {"flights", result.flights},
                                       {"interrupted", result.interrupted},
                                       {"contacts", result.contacts},
                                       {"faults", result.faults},
                                       {"left_out", means.left_out},
                                       {"lost", result.lost},
                                       {"failures", result.failures}};
  std::puts(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

void print_text(const ChaosMeans& means, const ChaosResult& result) {
  std::string text = fmt::format(
      "chaos            {}\nflights          {}{}\ncontacts         {}\nrobots lost      {}\n",
      result.failures.empty() ? "ok" : "promises broken", result.flights,
      result.interrupted ? ", the last one interrupted" : "", result.contacts, result.lost.size());
  for (const auto& [fault, why] : means.left_out) {
    text += fmt::format("left out         {}: {}\n", fault, why);
  }
  text += "faults\n";
  for (const auto& [kind, count] : result.faults) text += fmt::format("  {:<16} {}\n", kind, count);
  for (const auto& lost : result.lost) {
    text += fmt::format("- {}: robot {} was lost: {}\n", lost["run"].get<std::string>(),
                        lost["robot"].get<std::uint32_t>(), lost["why"].get<std::string>());
  }
  for (const auto& failure : result.failures) {
    text +=
        fmt::format("- {}: {} (repeat: --seed {} --minutes 0)\n", failure["run"].get<std::string>(),
                    failure["why"].get<std::string>(), failure["seed"].get<std::uint64_t>());
  }
  std::fputs(text.c_str(), stdout);
}

}  // namespace

Result<ExitCode> chaos(const ChaosOptions& options) {
  const auto robots = options.robots > 0 ? std::optional(options.robots) : std::nullopt;
  const auto mission = load_mission(options.mission, builtin_catalogue(), robots);
  if (!mission) return tl::unexpected(mission.error());
  const auto out = shell::claim_dir(options.out, "chaos-" + mission->name);
  if (!out) return tl::unexpected(out.error());
  const ChaosMeans means = find_means(*out);
  Progress progress;
  ChaosResult result;
  const SteadyTime begin = std::chrono::steady_clock::now();
  do {
    progress.show("chaos",
                  fmt::format("flight {}, {:.0f} of {:.0f} min, {} failures", result.flights + 1,
                              to_seconds(std::chrono::steady_clock::now() - begin) / 60.0,
                              options.minutes, result.failures.size()));
    auto spec = draw_flight(options.seed + result.flights, options, *mission, means);
    if (auto flown = fly_once(std::move(spec), *out, means, result); !flown) {
      return tl::unexpected(flown.error());
    }
  } while (to_seconds(std::chrono::steady_clock::now() - begin) < 60.0 * options.minutes &&
           shell::stop_requests() == 0);
  if (options.json) {
    print_json(options, means, result);
  } else {
    print_text(means, result);
  }
  return result.failures.empty() ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
}

}  // namespace swarm::launcher
