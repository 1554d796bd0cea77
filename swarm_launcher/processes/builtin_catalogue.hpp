// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/mission/catalogue.hpp"

namespace swarm {

/// The planning methods, control methods and drivers of our own programs.
const Catalogue& builtin_catalogue();

}  // namespace swarm
