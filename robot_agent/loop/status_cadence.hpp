// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace swarm::agent {

/// When robots report their status without a reason: every `every()` ticks, each in its turn, so
/// that neighbours in number do not report at the same tick.
class StatusCadence {
 public:
  /// \pre both rates are positive
  StatusCadence(double control_hz, double status_hz)
      : every_(static_cast<std::uint64_t>(std::max(1.0, std::round(control_hz / status_hz)))) {}

  std::uint64_t every() const { return every_; }

  /// The smallest number whose turn is at this tick, counted from 0; then every every()-th.
  std::uint64_t first_in_turn(std::uint64_t tick) const {
    return (every_ - tick % every_) % every_;
  }
  bool is_due(std::uint64_t number, std::uint64_t tick) const {
    return (number + tick) % every_ == 0;
  }

 private:
  std::uint64_t every_;
};

}  // namespace swarm::agent
