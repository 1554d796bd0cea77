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
struct Picture {
  struct Robot {
    float x_m = 0.0F;
    float y_m = 0.0F;
    float heading = 0.0F;
    bool heard_of = false;
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
std::optional<Picture> read_picture(std::span<const std::byte> bytes);

}  // namespace swarm::monitor
