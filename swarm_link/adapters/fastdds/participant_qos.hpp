// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"
#include "swarm_link/adapters/fastdds/loopback_transport.hpp"

/// Participant settings, the same for the clients of a run and its discovery server. Unequal leases
/// break rediscovery, so they are written in one place only.
namespace swarm::link::fastdds {

/// First metatraffic and data port of a participant: 7400 + 250·domain + 10 (+1) + 2·index.
struct Ports {
  std::uint16_t metatraffic = 0;
  std::uint16_t data = 0;
};
Result<Ports> first_ports(std::uint32_t domain, std::uint32_t index);

/// GUID prefix of the discovery server at a port: clients know it without asking.
eprosima::fastrtps::rtps::GuidPrefix_t server_prefix(std::uint32_t domain, std::uint16_t port);

eprosima::fastdds::dds::DomainParticipantQos client_qos(const FastDdsOptions& options, Ports ports,
                                                        std::shared_ptr<ReceiveSockets> sockets);

eprosima::fastdds::dds::DomainParticipantQos server_qos(std::uint32_t domain, std::uint16_t port,
                                                        Ports unused_data_ports,
                                                        std::shared_ptr<ReceiveSockets> sockets);

/// Settings of the vendor's library that are per process: errors to stderr only, no shortcut
/// between participants of one process (one way for every sample: the one the tests test).
void set_up_library();

}  // namespace swarm::link::fastdds
