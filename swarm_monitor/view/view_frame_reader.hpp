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
    float x_m = 0.0F;
    float y_m = 0.0F;
    float heading = 0.0F;
    bool was_received = false;
  };
  /// Mean [m] and covariance [m²] of a component of the planned mixture, and its share of the
  /// swarm.
  struct Component {
    float x_m = 0.0F;
    float y_m = 0.0F;
    float xx = 0.0F;
    float xy = 0.0F;
    float yy = 0.0F;
    float weight = 0.0F;
  };
  std::vector<Robot> robots{};
  std::vector<Component> mixture{};
};

/// Empty if the bytes are not a frame.
std::optional<ViewFrame> read_view_frame(std::span<const std::byte> bytes);

}  // namespace swarm::monitor
