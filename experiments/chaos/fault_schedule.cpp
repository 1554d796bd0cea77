// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/fault_schedule.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace swarm::launcher {
namespace {

/// Relative frequency of a kind, and the range of its duration [s]; 0: for good.
struct Share {
  FaultKind kind;
  double weight;
  double least_s, most_s;
};
constexpr std::array<Share, 7> kShares = {{{FaultKind::kKillAgent, 2.0, 0.0, 0.0},
                                           {FaultKind::kFreezeAgent, 4.0, 0.5, 8.0},
                                           {FaultKind::kKillPlanner, 1.0, 0.0, 0.0},
                                           {FaultKind::kFreezePlanner, 1.0, 0.5, 6.0},
                                           {FaultKind::kFreezeLauncher, 1.0, 0.5, 6.0},
                                           {FaultKind::kPause, 1.0, 0.5, 3.0},
                                           {FaultKind::kAddObstacle, 1.0, 3.0, 8.0}}};

const Share& draw_kind(Rng& rng) {
  double left = uniform(rng, 0.0,
                        std::accumulate(kShares.begin(), kShares.end(), 0.0,
                                        [](double sum, const Share& s) { return sum + s.weight; }));
  for (const Share& share : kShares) {
    left -= share.weight;
    if (left < 0.0) return share;
  }
  return kShares.back();
}

bool hits_an_agent(FaultKind kind) {
  return kind == FaultKind::kKillAgent || kind == FaultKind::kFreezeAgent;
}

}  // namespace

std::string_view to_string(FaultKind kind) {
  switch (kind) {
    case FaultKind::kKillAgent:
      return "kill-agent";
    case FaultKind::kFreezeAgent:
      return "freeze-agent";
    case FaultKind::kKillPlanner:
      return "kill-planner";
    case FaultKind::kFreezePlanner:
      return "freeze-planner";
    case FaultKind::kFreezeLauncher:
      return "freeze-launcher";
    case FaultKind::kPause:
      return "pause";
    case FaultKind::kAddObstacle:
      return "add-obstacle";
  }
  return "unknown";
}

// Times between faults are exponential, as those of independent causes.
std::vector<Fault> draw_faults(const ChaosLimits& limits, Rng& rng) {
  std::vector<std::uint32_t> untouched(limits.agents);
  std::iota(untouched.begin(), untouched.end(), 0U);
  auto kills_left = static_cast<std::uint32_t>(limits.kill_share * limits.agents);
  std::vector<Fault> faults;
  for (double at_s = 0.0;;) {
    at_s -= limits.every_s * std::log(1.0 - uniform01(rng));
    if (at_s >= limits.until_s) return faults;
    const Share& share = draw_kind(rng);
    Fault fault{.at = from_seconds(at_s),
                .lasts = from_seconds(uniform(rng, share.least_s, share.most_s)),
                .kind = share.kind,
                .x_share = uniform01(rng),
                .y_share = uniform01(rng)};
    if (hits_an_agent(fault.kind)) {
      if (untouched.empty() || (fault.kind == FaultKind::kKillAgent && kills_left == 0)) continue;
      if (fault.kind == FaultKind::kKillAgent) --kills_left;
      const std::size_t chosen = rng() % untouched.size();
      fault.agent = untouched[chosen];
      untouched.erase(untouched.begin() + static_cast<std::ptrdiff_t>(chosen));
    }
    faults.push_back(fault);
  }
}

std::string draw_network(Rng& rng) {
  const double loss = uniform(rng, 0.0, 0.2), delay_ms = uniform(rng, 0.0, 100.0);
  const double from_s = uniform(rng, 3.0, 20.0), blackout_s = uniform(rng, 1.0, 4.0);
  switch (rng() % 3) {
    case 0:
      return "";
    case 1:
      return fmt::format("loss={:.2f},delay-ms={:.0f},jitter-ms={:.0f}", loss, delay_ms,
                         0.3 * delay_ms);
    default:
      return fmt::format("loss=1,from={:.1f},to={:.1f}", from_s, from_s + blackout_s);
  }
}

}  // namespace swarm::launcher
