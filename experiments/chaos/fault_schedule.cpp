// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/fault_schedule.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace swarm::launcher {
namespace {

/// Relative frequency of a kind, and the range of its duration [s]; 0: for good.
struct Share {
  FaultKind kind;
  double weight;
  double least_s, most_s;
};
constexpr std::array<Share, kFaultKinds> kShares = {{{FaultKind::kKillAgent, 2.0, 0.0, 0.0},
                                                     {FaultKind::kFreezeAgent, 4.0, 0.5, 8.0},
                                                     {FaultKind::kHangAgent, 0.5, 0.0, 0.0},
                                                     {FaultKind::kKillPlanner, 1.0, 0.0, 0.0},
                                                     {FaultKind::kFreezePlanner, 1.0, 0.5, 6.0},
                                                     {FaultKind::kHangPlanner, 0.5, 0.0, 0.0},
                                                     {FaultKind::kFreezeLauncher, 1.0, 0.5, 6.0},
                                                     {FaultKind::kKillGateway, 1.0, 0.0, 0.0},
                                                     {FaultKind::kFreezeGateway, 1.0, 0.5, 6.0},
                                                     {FaultKind::kPause, 1.0, 0.5, 3.0},
                                                     {FaultKind::kAddObstacle, 1.0, 0.0, 0.0},
                                                     {FaultKind::kFillDisk, 1.0, 1.0, 8.0},
                                                     {FaultKind::kStepClock, 1.0, 0.5, 8.0},
                                                     {FaultKind::kCutHosts, 2.0, 0.5, 6.0}}};

/// A second over the limits of what clocks and messages are compared with, a minute, an hour.
constexpr std::array<std::int64_t, 6> kSteps_s = {-3600, -60, -8, 11, 60, 3600};

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

bool hits_an_agent(FaultKind kind) { return loses_robots(kind) || kind == FaultKind::kFreezeAgent; }

bool has_target(FaultKind kind, const ChaosLimits& limits) {
  switch (kind) {
    case FaultKind::kKillGateway:
    case FaultKind::kFreezeGateway:
      return limits.gateway;
    case FaultKind::kCutHosts:
      return limits.two_hosts;
    default:
      return true;
  }
}

}  // namespace

bool loses_robots(FaultKind kind) {
  return kind == FaultKind::kKillAgent || kind == FaultKind::kHangAgent;
}

std::string_view to_string(FaultKind kind) {
  switch (kind) {
    case FaultKind::kKillAgent:
      return "kill-agent";
    case FaultKind::kFreezeAgent:
      return "freeze-agent";
    case FaultKind::kHangAgent:
      return "hang-agent";
    case FaultKind::kKillPlanner:
      return "kill-planner";
    case FaultKind::kFreezePlanner:
      return "freeze-planner";
    case FaultKind::kHangPlanner:
      return "hang-planner";
    case FaultKind::kFreezeLauncher:
      return "freeze-launcher";
    case FaultKind::kKillGateway:
      return "kill-gateway";
    case FaultKind::kFreezeGateway:
      return "freeze-gateway";
    case FaultKind::kPause:
      return "pause";
    case FaultKind::kAddObstacle:
      return "add-obstacle";
    case FaultKind::kFillDisk:
      return "fill-disk";
    case FaultKind::kStepClock:
      return "step-clock";
    case FaultKind::kCutHosts:
      return "cut-hosts";
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
                .y_share = uniform01(rng),
                .step_s = kSteps_s[rng() % kSteps_s.size()]};
    if (!has_target(fault.kind, limits)) continue;
    if (hits_an_agent(fault.kind)) {
      if (untouched.empty() || (loses_robots(fault.kind) && kills_left == 0)) continue;
      if (loses_robots(fault.kind)) --kills_left;
      const std::size_t chosen = rng() % untouched.size();
      fault.agent = untouched[chosen];
      untouched.erase(untouched.begin() + static_cast<std::ptrdiff_t>(chosen));
    }
    faults.push_back(fault);
  }
}

}  // namespace swarm::launcher
