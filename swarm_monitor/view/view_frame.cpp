// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/view_frame.hpp"

#include <algorithm>
#include <cstring>

namespace swarm::monitor {

template <class T>
void ViewFrameEncoder::put(T value) {
  // Memory order is wire order, since all supported machines are little-endian.
  const std::size_t at = out_.size();
  out_.resize(at + sizeof(T));
  std::memcpy(out_.data() + at, &value, sizeof(T));
}

// The difference is taken before the precision is lost.
void ViewFrameEncoder::put_position(const Vec2& position_m) {
  put(static_cast<float>(position_m.x() - origin_m_.x()));
  put(static_cast<float>(position_m.y() - origin_m_.y()));
}

// Multiples of 1 km, so that the lines of the page's grid stay where they are.
Vec2 view_origin_m(const Box& bounds_m) {
  constexpr double kExact_m = 4096.0;  // a float resolves half a millimetre up to here
  constexpr double kRound_m = 1000.0;
  const double farthest_m =
      std::max(bounds_m.min_m.cwiseAbs().maxCoeff(), bounds_m.max_m.cwiseAbs().maxCoeff());
  if (farthest_m <= kExact_m) return Vec2::Zero();
  return kRound_m * (bounds_m.min_m / kRound_m).array().round().matrix();
}

/// Header: magic, number of robots, time, phase, number of mixture components; 24 bytes.
ViewFrameEncoder::ViewFrameEncoder(std::vector<std::byte>& out, std::uint32_t robots, double time_s,
                                   std::uint32_t phase, const std::optional<Mixture>& mixture)
    : out_(out), mixture_(mixture) {
  out_.clear();
  for (const char c : {'S', 'W', 'F', '1'}) put(c);
  put(robots);
  put(time_s);
  put(phase);
  put(static_cast<std::uint32_t>(mixture ? mixture->components().size() : 0));
}

/// 16 bytes per robot: three floats and four bytes, so that the page reads both as typed arrays.
void ViewFrameEncoder::add(const FrameRobot& robot) {
  put_position(robot.position_m);
  put(static_cast<float>(robot.heading_rad));
  put(static_cast<std::uint8_t>(robot.mode));
  put(robot.goal);
  put(static_cast<std::uint8_t>((robot.was_received ? 1 : 0) | (robot.arrived ? 2 : 0) |
                                (robot.lost ? 4 : 0)));
  put(robot.neighbours);
}

/// After the robots: six floats per component, then the chosen robot and what it estimates of
/// others.
void ViewFrameEncoder::finish(std::optional<RobotId> focus,
                              const std::vector<FrameEstimate>& estimates) {
  if (mixture_) {
    for (const WeightedGaussian& component : mixture_->components()) {
      const Mat2& c = component.gaussian.covariance_m2();
      put_position(component.gaussian.mean_m());
      for (const double value : {c(0, 0), c(0, 1), c(1, 1), component.weight}) {
        put(static_cast<float>(value));
      }
    }
  }
  put(focus ? focus->value() : 0xFFFF'FFFFU);
  put(static_cast<std::uint32_t>(estimates.size()));
  for (const FrameEstimate& estimate : estimates) {
    put(estimate.neighbour.value());
    put_position(estimate.position_m);
  }
}

}  // namespace swarm::monitor
