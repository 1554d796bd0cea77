// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/view_frame.hpp"

#include <cstring>

namespace swarm::monitor {

template <class T>
void ViewFrameEncoder::put(T value) {
  // Memory order is wire order, since all supported machines are little-endian.
  const std::size_t at = out_.size();
  out_.resize(at + sizeof(T));
  std::memcpy(out_.data() + at, &value, sizeof(T));
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
  put(static_cast<float>(robot.position_m.x()));
  put(static_cast<float>(robot.position_m.y()));
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
      const Gaussian& g = component.gaussian;
      for (const double value :
           {g.mean_m().x(), g.mean_m().y(), g.covariance_m2()(0, 0), g.covariance_m2()(0, 1),
            g.covariance_m2()(1, 1), component.weight}) {
        put(static_cast<float>(value));
      }
    }
  }
  put(focus ? focus->value() : 0xFFFF'FFFFU);
  put(static_cast<std::uint32_t>(estimates.size()));
  for (const FrameEstimate& estimate : estimates) {
    put(estimate.neighbour.value());
    put(static_cast<float>(estimate.position_m.x()));
    put(static_cast<float>(estimate.position_m.y()));
  }
}

}  // namespace swarm::monitor
