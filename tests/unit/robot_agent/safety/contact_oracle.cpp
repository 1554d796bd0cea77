// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/robot_agent/safety/contact_oracle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace swarm::agent {
namespace {

constexpr int kDirections = 256;
constexpr std::array kSpeeds{1.0, 0.75, 0.5, 0.25, 0.0};  // shares of the largest

}  // namespace

/// When one more falls silent, discs that the robot could outrun one by one may close in on it.
void ContactOracle::on_tick(std::size_t robot, SteadyTime now, const Vec2& position_m) {
  bool is_news = false;
  for (std::size_t other = 0; other < options_.robots; ++other) {
    Known& known = of(robot, other);
    if (other == robot || known.is_silent) continue;
    known.is_silent = now - known.as_of > options_.expected_silence;
    known.is_within = false;
    is_news = is_news || known.is_silent;
  }
  if (!is_news || can_outrun(robot, now, position_m)) return;
  for (std::size_t other = 0; other < options_.robots; ++other) {
    of(robot, other).is_within = of(robot, other).is_silent;
  }
}

/// Straight runs at constant speed are enough: a disc grows at the largest speed, so that one which
/// is outside of it now and when it stands is so all the time between (the difference of the
/// squared distances is concave in time), and each end of a path is the end of a straight one. Of
/// those a grid is tried.
bool ContactOracle::can_outrun(std::size_t robot, SteadyTime now, const Vec2& position_m) {
  struct Disc {
    Vec2 offset_m;
    double grows_s;
    double final_m;
  };
  std::vector<Disc> discs;
  for (std::size_t other = 0; other < options_.robots; ++other) {
    const Known& known = of(robot, other);
    if (!known.is_silent) continue;
    const double stands_s = to_seconds(options_.stands_after);
    const double age_s = std::min(to_seconds(now - known.as_of), stands_s);
    discs.push_back({.offset_m = position_m - known.position_m,
                     .grows_s = stands_s - age_s,
                     .final_m = options_.speed_mps * stands_s + 2 * options_.radius_m});
    const double reached_m = discs.back().final_m - options_.speed_mps * discs.back().grows_s;
    if (discs.back().offset_m.norm() <= reached_m) return false;
  }
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2 * std::numbers::pi * i / kDirections;
    for (const double share : kSpeeds) {
      const Vec2 run_mps = share * options_.speed_mps * Vec2(std::cos(angle), std::sin(angle));
      const auto keeps_out = [&](const Disc& disc) {
        return (disc.offset_m + disc.grows_s * run_mps).norm() >= disc.final_m;
      };
      if (std::ranges::all_of(discs, keeps_out)) return true;
    }
  }
  return false;
}

ContactOracle::Awareness ContactOracle::awareness(std::size_t robot, std::size_t other) const {
  if (robots_[robot].is_unable) return Awareness::kUnable;
  const Known& known = known_[robot * options_.robots + other];
  if (known.is_silent) return known.is_within ? Awareness::kWithin : Awareness::kOutside;
  return known.has_lost ? Awareness::kUnaware : Awareness::kReceiving;
}

bool ContactOracle::counts(std::size_t a, std::size_t b) const {
  const auto can_avoid = [this](std::size_t robot, std::size_t other) {
    const Awareness known = awareness(robot, other);
    return known == Awareness::kReceiving || known == Awareness::kOutside;
  };
  if (robots_[a].is_adversarial) return can_avoid(b, a);
  if (robots_[b].is_adversarial) return can_avoid(a, b);
  if (can_avoid(a, b) || can_avoid(b, a)) return true;
  return awareness(a, b) != Awareness::kUnaware && awareness(b, a) != Awareness::kUnaware;
}

}  // namespace swarm::agent
