// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/cyclone/cyclone_participant.hpp"

namespace swarm::link {

Result<std::unique_ptr<Participant>> make_cyclone_participant(const CycloneOptions&) {
  return fail(ErrorCode::kBadInput,
              "this program was built without Cyclone DDS (SWARM_WITH_CYCLONEDDS=OFF)");
}

}  // namespace swarm::link
