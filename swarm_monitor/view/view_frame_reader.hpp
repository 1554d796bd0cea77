// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace swarm::monitor {

/// What Foxglove gets out of a picture (PROTOCOL.md).
struct ViewFrame {
  struct Robot {
    float x_m = 0.0F;
    float y_m = 0.0F;
    float heading = 0.0F;
    bool was_received = false;
  };
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

/// None if the bytes are no picture.
std::optional<ViewFrame> read_view_frame(std::span<const std::byte> bytes);

}  // namespace swarm::monitor
