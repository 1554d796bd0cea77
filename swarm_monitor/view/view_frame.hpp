// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "swarmflow/core/box.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::monitor {

/// A robot as frames show it.
struct FrameRobot {
  Vec2 position_m = Vec2::Zero();
  double heading_rad = 0.0;
  RobotMode mode = RobotMode::kWaiting;
  std::uint8_t goal = 255;      ///< index of the component; 255: none
  std::uint8_t neighbours = 0;  ///< received neighbours, at most 255
  bool was_received = false, arrived = false, lost = false;
};

/// A neighbour of the chosen robot, at the position that the robot estimates.
struct FrameEstimate {
  RobotId neighbour{};
  Vec2 position_m = Vec2::Zero();
};

/// Phase in a frame of a run that has ended.
inline constexpr std::uint32_t kEndedPhase = 4;

/// Where the coordinates of frames begin: (0, 0), or a round point near the corner of a world so
/// far from it, as one in map coordinates is, that floats do not resolve centimetres.
Vec2 view_origin_m(const Box& bounds_m);

/// Encodes a frame of PROTOCOL.md: the constructor writes the header, add() one robot each, in the
/// order of ids, finish() mixture and estimates.
class ViewFrameEncoder {
 public:
  ViewFrameEncoder(
      std::vector<std::byte>& out, std::uint32_t robots, double time_s,
      /// `out` is replaced and filled until finish(); `mixture` must outlive the encoder.
      std::uint32_t phase, const std::optional<Mixture>& mixture);
  /// Positions are encoded relative to this point, view_origin_m() of the world; (0, 0) by default.
  void set_origin(const Vec2& origin_m) { origin_m_ = origin_m; }
  void add(const FrameRobot& robot);
  /// `focus` is the chosen robot, `estimates` the positions of its neighbours.
  void finish(std::optional<RobotId> focus, const std::vector<FrameEstimate>& estimates);

 private:
  template <class T>
  void put(T value);
  void put_position(const Vec2& position_m);
  Vec2 origin_m_ = Vec2::Zero();
  std::vector<std::byte>& out_;
  const std::optional<Mixture>& mixture_;
};

}  // namespace swarm::monitor
