// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "swarm_link/port.hpp"

namespace swarm::link {

/// Combines several participants: a writer sends through each of them, a reader receives from all.
/// For processes that communicate with everyone in a swarm of hundreds: the reliable discovery of a
/// vendor costs the square of the number of peers of a participant, so the peers are divided among
/// several. \pre at least one participant
std::unique_ptr<Participant> make_relay_participant(
    std::vector<std::unique_ptr<Participant>> participants);

}  // namespace swarm::link
