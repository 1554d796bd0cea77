// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/check/driver_trial.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "robot_agent/safety/fault_text.hpp"

namespace swarm::agent {
namespace {

constexpr int kTicksPerHealth = 10;

}  // namespace

template <class Call>
void DriverTrial::timed(Call call) {
  const SteadyTime before = clock_.now();
  call();
  ++calls_;
  if (clock_.now() - before > options_.period / 2) ++slow_calls_;
}

const Measurement& DriverTrial::tick(const std::function<void(SteadyTime)>& act) {
  clock_.sleep_until(next_);
  const SteadyTime now = std::max(clock_.now(), next_);
  next_ = now + options_.period;
  timed([&] { newest_ = driver_.measure(now); });
  look_at(newest_);
  timed([&] { act(now); });
  if (ticks_++ % kTicksPerHealth == 0) {
    timed([&] { health_ = driver_.health(); });
    look_at(health_);
  }
  return newest_;
}

/// Whether the robot is to stop now: it left its room, or an operator ends the check.
bool DriverTrial::must_end() {
  if (!ended_.empty()) return true;
  const bool is_outside = middle_m_ && newest_.is_valid &&
                          !((position_m() - *middle_m_).cwiseAbs().maxCoeff() <= options_.room_m);
  if (is_outside) ended_ = fmt::format("it left its room of {:g} m", options_.room_m);
  if (options_.must_end && options_.must_end()) ended_ = "ended by the operator";
  return !ended_.empty();
}

void DriverTrial::drive(const Vec2& velocity_mps, Duration span) {
  for (const SteadyTime until = next_ + span; next_ < until && !must_end();) {
    tick([&](SteadyTime now) { driver_.command(now, velocity_mps, 2 * options_.period); });
  }
}

void DriverTrial::stop(StopKind kind, Duration span) {
  for (const SteadyTime until = next_ + span; next_ < until;) {
    tick([&](SteadyTime now) { driver_.stop(now, kind); });
  }
}

bool DriverTrial::wait(Duration span, const std::function<bool(const Measurement&)>& until) {
  for (const SteadyTime end = next_ + span; next_ < end && !must_end();) {
    if (until(tick())) return true;
  }
  return false;
}

void DriverTrial::freeze(Duration span) {
  if (must_end()) return;
  next_ += span;
  clock_.sleep_until(next_);
}

void DriverTrial::look_at(const Measurement& m) {
  if (!nonsense_.empty()) return;
  if (m.is_valid && !m.position_m.allFinite()) {
    nonsense_ = "a valid position is not finite";
  } else if (m.age < Duration::zero()) {
    nonsense_ = "the age of a position is negative";
  } else if (m.velocity_mps && !m.velocity_mps->allFinite()) {
    nonsense_ = "a velocity is not finite";
  } else if (m.heading_rad && !(std::abs(*m.heading_rad) <= std::numbers::pi + 1e-9)) {
    nonsense_ = "a heading is not in [-pi, pi]";
  } else if (m.covariance_m2 && !m.covariance_m2->allFinite()) {
    nonsense_ = "a covariance is not finite";
  } else if (m.height_m && !std::isfinite(*m.height_m)) {
    nonsense_ = "a height is not finite";
  }
}

void DriverTrial::look_at(const DriverHealth& health) {
  if (!nonsense_.empty()) return;
  if (health.level != DriverHealth::Level::kGood && health.text.empty()) {
    nonsense_ = "a health that is not good has no text";
  } else if (fault_text(health.text) != health.text) {
    nonsense_ = "the text of the health is longer than a line";
  } else if (health.battery && !(*health.battery >= 0.0 && *health.battery <= 1.0)) {
    nonsense_ = "the charge of the battery is not in [0, 1]";
  }
}

}  // namespace swarm::agent
