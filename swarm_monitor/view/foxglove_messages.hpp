// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "swarm_monitor/view/view_frame_reader.hpp"
#include "swarmflow/core/time.hpp"

/// Foxglove's schemas as CDR.
namespace swarm::monitor::foxglove {

using Bytes = std::vector<std::byte>;

/// foxglove::PosesInFrame: position and heading of every robot that was received.
Bytes poses_in_frame(UtcTime now, const ViewFrame& view_frame);

/// foxglove::SceneUpdate: an ellipse of two standard deviations for every component.
Bytes mixture_scene(UtcTime now, const ViewFrame& view_frame);

/// foxglove::SceneUpdate: the obstacles of a `scene` message (PROTOCOL.md).
Bytes obstacles_scene(UtcTime now, std::string_view scene_json);

}  // namespace swarm::monitor::foxglove
