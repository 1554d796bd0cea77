// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Foxglove's own schemas as OMG IDL, each with everything it needs. Field order is the encoding:
/// foxglove_messages.cpp follows it.
namespace swarm::monitor::foxglove {

extern const std::string_view kPosesInFrameIdl;
extern const std::string_view kSceneUpdateIdl;

}  // namespace swarm::monitor::foxglove
