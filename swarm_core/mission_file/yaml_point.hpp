// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <fmt/format.h>

#include "swarmflow/core/linalg.hpp"

namespace swarm {

/// A point as a mission file writes it, "[1.5, 2]".
inline std::string yaml_point(const Vec2& p) { return fmt::format("[{}, {}]", p.x(), p.y()); }

}  // namespace swarm
