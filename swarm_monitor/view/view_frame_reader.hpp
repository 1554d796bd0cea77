// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace swarm::monitor {

/// The part of a frame (PROTOCOL.md) that Foxglove's messages need.
struct ViewFrame {
  /// Position [m] and heading [rad] in the frame of the map; a robot never received has none.
  struct Robot {
    double x_m = 0.0;
    double y_m = 0.0;
    float heading = 0.0F;
    bool was_received = false;
  };
  /// Mean [m] and covariance [m²] of a component of the planned mixture, and its share of the
  /// swarm.
  struct Component {
    double x_m = 0.0;
    double y_m = 0.0;
    float xx = 0.0F;
    float xy = 0.0F;
    float yy = 0.0F;
    float weight = 0.0F;
  };
  std::vector<Robot> robots{};
  std::vector<Component> mixture{};
};

/// Positions are relative to `origin_m` in the frame and absolute in the result. Empty if the bytes
/// are not a frame.
std::optional<ViewFrame> read_view_frame(std::span<const std::byte> bytes,
                                         const Vec2& origin_m = Vec2::Zero());

}  // namespace swarm::monitor
