// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "swarmflow/mission/options.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {

/// Key `control`: the control method, and the options of the built-in ones.
struct ControlSpec {
  std::string method = "apf";  ///< name of a control method that the robots' program has
  double rate_hz = 10.0;       ///< rate of the control loop, 1/Δt
  double cruise_mps = 1.45;    ///< largest desired speed along the path [m/s]
  /// Set if the robots fill the drawing of the goal: the tolerance of its shape function [m²]
  /// within which a robot has arrived. Unset, `auto` in the file: the reader sets it as the method
  /// declares it, see ComponentSpec::shape_tolerance.
  std::optional<double> shape_tolerance_m2{};
  OptionValues options{};  ///< options that the control methods declare
};

/// Keys that every control method reads, beside `method` and `shape_tolerance_m2`.
inline constexpr auto kControlKeys = std::to_array<SectionKey<ControlSpec>>({
    {"rate_hz", &ControlSpec::rate_hz, between(0.5, 1000), "control steps per second"},
    {"cruise_mps", &ControlSpec::cruise_mps, positive(100), "largest desired speed along the path"},
});

}  // namespace swarm
