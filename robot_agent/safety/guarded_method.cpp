// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/safety/guarded_method.hpp"

#include <cmath>
#include <exception>

#include "robot_agent/safety/fault_text.hpp"

namespace swarm::agent {

/// Calls the method unless it has failed before. The first exception is kept as the fault; from
/// then on every call returns `otherwise`, so a robot with a broken method stays where it is.
template <class T, class Call>
T GuardedMethod::guarded(T otherwise, Call call) const {
  if (!fault_.empty()) return otherwise;
  try {
    return call(*method_);
  } catch (const std::exception& e) {
    fault_ = fault_text(std::string("the control method threw: ") + e.what());
  } catch (...) {
    fault_ = "the control method threw what is no std::exception";
  }
  return otherwise;
}

/// Comparisons with NaN are false, so the safety filter would not limit one: it is caught here.
Vec2 GuardedMethod::checked(const Vec2& velocity_mps) {
  if (std::isfinite(velocity_mps.x()) && std::isfinite(velocity_mps.y())) return velocity_mps;
  fault_ = "the control method returned a velocity that is not finite";
  return Vec2::Zero();
}

/// The bus refuses a status with a number that is not finite, and a status is that of many robots.
double GuardedMethod::checked(double value, const char* name) const {
  if (std::isfinite(value)) return value;
  fault_ = std::string("the control method returned a ") + name + " that is not finite";
  return 0.0;
}

/// Goals first: a method may need them to begin a route.
void GuardedMethod::begin(const FlowPlan& plan, const Route& route, const World& world) {
  guarded(0, [&](ControlMethod& m) {
    m.set_goals(plan);
    m.begin(route, world);
    return 0;
  });
}

[[gnu::hot]] bool GuardedMethod::has_arrived(const ControlView& view) {
  return guarded(false, [&](ControlMethod& m) { return m.has_arrived(view); });
}

[[gnu::hot]] Vec2 GuardedMethod::desired_velocity(const ControlView& view, bool arrived, Rng& rng) {
  return checked(guarded<Vec2>(
      Vec2::Zero(), [&](ControlMethod& m) { return m.desired_velocity(view, arrived, rng); }));
}

Vec2 GuardedMethod::hold(const ControlView& view) {
  return checked(guarded<Vec2>(Vec2::Zero(), [&](ControlMethod& m) { return m.hold(view); }));
}

[[gnu::hot]] std::uint32_t GuardedMethod::goal(const Vec2& position_m) const {
  return guarded(0U, [&](const ControlMethod& m) { return m.goal(position_m); });
}

[[gnu::hot]] std::optional<TimeTracking> GuardedMethod::tracking() const {
  auto tracking =
      guarded(std::optional<TimeTracking>{}, [](const ControlMethod& m) { return m.tracking(); });
  if (tracking && !(std::isfinite(tracking->plan_time_s) && tracking->reference_m.allFinite())) {
    fault_ = "the control method returned a reference that is not finite";
    tracking.reset();
  }
  return tracking;
}

double GuardedMethod::lag_s() const {
  return checked(guarded(0.0, [](const ControlMethod& m) { return m.lag_s(); }), "lag");
}

[[gnu::hot]] double GuardedMethod::remaining_m() const {
  return checked(guarded(0.0, [](const ControlMethod& m) { return m.remaining_m(); }),
                 "remaining length");
}

std::uint32_t GuardedMethod::escapes() const {
  return guarded(0U, [](const ControlMethod& m) { return m.escapes(); });
}

}  // namespace swarm::agent
