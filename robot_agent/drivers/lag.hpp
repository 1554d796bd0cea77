// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/mission/body_limits.hpp"

namespace swarm::agent {

/// What the safety filter allows a body: body_lag_s().
inline double lag_s(const BodySpec& body) { return body_lag_s(body); }

}  // namespace swarm::agent
