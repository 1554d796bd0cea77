// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/mission/catalogue.hpp"

namespace swarm {

/// The planning methods, control methods and drivers of the programs of this build. Created at the
/// first call; safe from any thread.
const Catalogue& builtin_catalogue();

}  // namespace swarm
