// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"
#include "swarm_link/adapters/fastdds/loopback_transport.hpp"

/// Participant settings, the same for the clients of a run and its discovery server. They are set
/// here only, because participants with unequal leases do not rediscover each other.
namespace swarm::link::fastdds {

/// First metatraffic and data port of a participant: 7400 + 250·domain + 10 (+1) + 2·index.
struct Ports {
  std::uint16_t metatraffic = 0;
  std::uint16_t data = 0;
};
/// Fails when the index needs a port beyond the last one.
Result<Ports> first_ports(std::uint32_t domain, std::uint32_t index);

/// GUID prefix of the discovery server at a port. It is computed, so clients need no look-up to
/// know it.
eprosima::fastrtps::rtps::GuidPrefix_t server_prefix(std::uint32_t domain, std::uint16_t port);

/// Settings of a participant of a run: client of the discovery server or with static peers.
eprosima::fastdds::dds::DomainParticipantQos client_qos(const FastDdsOptions& options, Ports ports,
                                                        std::shared_ptr<ReceiveSockets> sockets);

/// Settings of a participant in a domain that programs of others use. \pre options.open
eprosima::fastdds::dds::DomainParticipantQos open_qos(const FastDdsOptions& options);

/// Settings of the discovery server, which listens at `port`. It exchanges no user data, but the
/// vendor needs a data port all the same.
eprosima::fastdds::dds::DomainParticipantQos server_qos(std::uint32_t domain, std::uint16_t port,
                                                        Ports unused_data_ports,
                                                        std::shared_ptr<ReceiveSockets> sockets);

/// Sets what the vendor's library has once per process: errors go to stderr only, and participants
/// of one process communicate over the network like all others (one path for every sample: the one
/// that the tests cover). Safe to call more than once and from any thread.
void set_up_library();

}  // namespace swarm::link::fastdds
