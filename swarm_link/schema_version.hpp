// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace swarm::link {

/// Of idl/swarm.idl; every message carries it first.
inline constexpr std::uint16_t kSchemaVersion = 4;

}  // namespace swarm::link
