// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::monitor {

/// A robot as pictures show it.
struct FrameRobot {
  Vec2 position_m = Vec2::Zero();
  double heading_rad = 0.0;
  RobotMode mode = RobotMode::kWaiting;
  std::uint8_t goal = 255;
  std::uint8_t neighbours = 0;
  bool was_received = false, arrived = false, lost = false;
};

struct FrameEstimate {
  RobotId neighbour{};
  Vec2 position_m = Vec2::Zero();
};

/// Phase of a picture of what has ended.
inline constexpr std::uint32_t kEndedPhase = 4;

/// Puts a picture of PROTOCOL.md together: its robots one by one, then finish().
class ViewFrameEncoder {
 public:
  ViewFrameEncoder(std::vector<std::byte>& out, std::uint32_t robots, double time_s,
               std::uint32_t phase, const std::optional<Mixture>& mixture);
  void add(const FrameRobot& robot);
  void finish(std::optional<RobotId> focus, const std::vector<FrameEstimate>& estimates);

 private:
  template <class T>
  void put(T value);
  std::vector<std::byte>& out_;
  const std::optional<Mixture>& mixture_;
};

}  // namespace swarm::monitor
