// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/mission/options.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {

/// A robot's body. Noise is zero-mean, Gaussian and independent per axis and control step.
struct BodySpec {
  std::string model = "single_integrator";  ///< name of a driver that the robots' program has
  double radius_m = 0.2;                    ///< radius of the disc that covers it
  double speed_max_mps = 1.5;               ///< its largest speed [m/s]
  double acceleration_max_mps2 = 3.0;  ///< of unicycle (along its heading) and double integrator
  double turn_rate_max_radps = 3.0;    ///< of unicycle [rad/s]
  double communication_radius_m =
      0.0;                        ///< its communication radius; 0: link.communication_radius_m
  double motion_noise_m = 0.0;    ///< σ of w(k) per control step [ROVER, eq. 9]
  double position_noise_m = 0.0;  ///< σ of its measured position [m]
  double pose_timeout_s = 0.5;    ///< an older measured position counts as none [s]
  double pose_sigma_max_m = 0.5;  ///< a less precise one counts as none: σ along its worst axis [m]
  /// Longest time that it takes to reach a commanded velocity [s]. Unset, `auto` in the file: the
  /// reader sets it as the driver declares it, see body_lag_s().
  std::optional<double> lag_s{};
  OptionValues options{};  ///< options that its driver declares
};

/// Keys of the body, of all robots and of each group, beside `model`, `lag_s` and the driver's
/// options.
inline constexpr auto kBodyKeys = std::to_array<SectionKey<BodySpec>>({
    {"radius_m", &BodySpec::radius_m, positive(100), "radius of the body"},
    {"speed_max_mps", &BodySpec::speed_max_mps, positive(100), "largest speed of the body"},
    {"acceleration_max_mps2", &BodySpec::acceleration_max_mps2, positive(1000),
     "largest acceleration: of unicycle (along its heading) and double_integrator"},
    {"turn_rate_max_radps", &BodySpec::turn_rate_max_radps, positive(1000), "unicycle"},
    {"communication_radius_m", &BodySpec::communication_radius_m, between(0, 10'000),
     "communication radius of the robot; 0: link.communication_radius_m"},
    {"motion_noise_m", &BodySpec::motion_noise_m, between(0, 100),
     "standard deviation of the noise that each control step adds to the motion, per axis"},
    {"position_noise_m", &BodySpec::position_noise_m, between(0, 100),
     "standard deviation of the measured position, per axis"},
    {"pose_timeout_s", &BodySpec::pose_timeout_s, positive(60),
     "a robot whose position is older holds"},
    {"pose_sigma_max_m", &BodySpec::pose_sigma_max_m, positive(100),
     "a robot whose position has a larger standard deviation along some axis holds"},
});

/// A number of robots that differ from the others.
struct RobotGroupSpec : BodySpec {
  std::uint32_t count = 1;  ///< number of robots with this body
};

/// Key `robots`: the swarm; its own BodySpec holds for robots outside of groups.
struct RobotsSpec : BodySpec {
  std::uint32_t count = 100;     ///< number of robots, N
  double placement_gap_m = 0.7;  ///< least gap between surfaces at the start [m]
  /// Groups with other bodies: they have the first ids, group after group.
  std::vector<RobotGroupSpec> groups;
};

/// Upper bound of `robots.count`.
inline constexpr double kMaxRobots = 200'000;

/// Keys of the swarm as a whole, beside `groups`.
inline constexpr auto kRobotsKeys = std::to_array<SectionKey<RobotsSpec>>({
    {"count", &RobotsSpec::count, between(1, kMaxRobots), "number of robots"},
    {"placement_gap_m", &RobotsSpec::placement_gap_m, between(0, 100),
     "least surface gap to robots and obstacles at the start"},
});

/// The body of one robot; a reference into `robots`. O(groups). \pre robot < robots.count, asserted
const BodySpec& body_of(const RobotsSpec& robots, RobotId robot);
/// The largest radius of any robot [m]. O(groups).
double largest_radius_m(const RobotsSpec& robots);
/// The largest speed of any robot [m/s].
double largest_speed_mps(const RobotsSpec& robots);

}  // namespace swarm
