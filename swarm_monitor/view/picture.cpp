// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/picture.hpp"

#include <cstring>

namespace swarm::monitor {

template <class T>
void PictureMaker::put(T value) {
  // Little-endian, as every machine we run on.
  const std::size_t at = out_.size();
  out_.resize(at + sizeof(T));
  std::memcpy(out_.data() + at, &value, sizeof(T));
}

PictureMaker::PictureMaker(std::vector<std::byte>& out, std::uint32_t robots, double time_s,
                           std::uint32_t phase, const std::optional<Mixture>& mixture)
    : out_(out), mixture_(mixture) {
  out_.clear();
  for (const char c : {'S', 'W', 'F', '1'}) put(c);
  put(robots);
  put(time_s);
  put(phase);
  put(static_cast<std::uint32_t>(mixture ? mixture->components().size() : 0));
}

void PictureMaker::add(const PictureRobot& robot) {
  put(static_cast<float>(robot.position_m.x()));
  put(static_cast<float>(robot.position_m.y()));
  put(static_cast<float>(robot.heading_rad));
  put(static_cast<std::uint8_t>(robot.mode));
  put(robot.goal);
  put(static_cast<std::uint8_t>((robot.heard_of ? 1 : 0) | (robot.arrived ? 2 : 0) |
                                (robot.lost ? 4 : 0)));
  put(robot.neighbours);
}

void PictureMaker::finish(std::optional<RobotId> focus, const std::vector<PictureBelief>& beliefs) {
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
  put(static_cast<std::uint32_t>(beliefs.size()));
  for (const PictureBelief& belief : beliefs) {
    put(belief.neighbour.value());
    put(static_cast<float>(belief.position_m.x()));
    put(static_cast<float>(belief.position_m.y()));
  }
}

}  // namespace swarm::monitor
