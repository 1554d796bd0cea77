// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarm_core/mission/vendor.hpp"

namespace swarm::link {

/// Whether an implementation is part of this build (SWARM_WITH_FASTDDS, SWARM_WITH_CYCLONEDDS).
/// Without it, creating its participants fails.
bool built_with(Vendor vendor);

}  // namespace swarm::link
