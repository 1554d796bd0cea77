// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "swarm_link/port.hpp"

namespace swarm::link {

/// Several participants as one: its writers say everything through each of them, its readers hear
/// through all. For those who speak to everyone in a swarm of hundreds: a vendor's reliable
/// discovery costs the square of the peers a participant has, so the crowd is dealt out to several.
/// \pre at least one participant
std::unique_ptr<Participant> make_relay_participant(std::vector<std::unique_ptr<Participant>> participants);

}  // namespace swarm::link
