// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"

namespace swarm::link {
namespace {

tl::unexpected<Error> unavailable() {
  return fail(ErrorCode::kBadInput,
              "this program was built without Fast DDS (SWARM_WITH_FASTDDS=OFF)");
}

}  // namespace

Result<std::unique_ptr<Participant>> make_fastdds_participant(const FastDdsOptions&) {
  return unavailable();
}

Result<std::unique_ptr<DiscoveryServer>> make_discovery_server(std::uint32_t, std::uint16_t) {
  return unavailable();
}

}  // namespace swarm::link
