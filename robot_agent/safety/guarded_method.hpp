// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "swarmflow/robot/control_slot.hpp"

namespace swarm::agent {

/// Isolates the robot from faults of its control method: exceptions end here, and a result that is
/// not finite is not passed on. After either the method is not called again and fault() has the
/// reason; the results are then those of a robot that stays where it is.
class GuardedMethod {
 public:
  explicit GuardedMethod(ControlSlot method) : method_(std::move(method)) {}

  void begin(const FlowPlan& plan, const Route& route, const World& world);
  bool has_arrived(const ControlView& view);
  Vec2 desired_velocity(const ControlView& view, bool arrived, Rng& rng);
  Vec2 hold(const ControlView& view);
  std::uint32_t goal(const Vec2& position_m) const;
  std::optional<TimeTracking> tracking() const;
  double lag_s() const;
  double remaining_m() const;
  std::uint32_t escapes() const;

  /// Empty while the method works; else one line that fits into an event.
  const std::string& fault() const { return fault_; }

 private:
  template <class T, class Call>
  T guarded(T otherwise, Call call) const;
  Vec2 checked(const Vec2& velocity_mps);
  double checked(double value, const char* name) const;

  ControlSlot method_;
  mutable std::string fault_;
};

}  // namespace swarm::agent
