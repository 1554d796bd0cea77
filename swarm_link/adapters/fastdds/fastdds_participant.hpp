// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "swarm_link/channels/faulty_path.hpp"
#include "swarm_link/port.hpp"
#include "swarmflow/core/result.hpp"

/// The Fast DDS adapter. This header includes no vendor header; those stay in this folder.
namespace swarm::link {

/// Address of the discovery server of a run; on the loopback interface unless set otherwise.
struct DiscoveryAddress {
  std::string host = "127.0.0.1";
  std::uint16_t port = 0;
};

/// Discovery without a server: a participant announces itself to a few listed peers, which answer,
/// and to no other participant. So the cost of discovery does not grow with the square of the
/// swarm.
struct StaticPeers {
  bool is_relay = false;               ///< peers know its port: it must get the port of its index
  std::vector<std::uint32_t> peers{};  ///< indices of the relay participants it announces itself to
  std::string host = "127.0.0.1";      ///< address of those peers
};

/// A domain that programs of others use, too, as those of ROS 2: participants discover each other
/// by multicast, or through a server, and the vendor's own transport and threads receive.
struct OpenDomain {
  std::optional<DiscoveryAddress> server{};  ///< instead of multicast
  std::vector<std::string> peers{};          ///< addresses to announce itself to beside multicast
  std::string user_data{};                   ///< announced with the participant
};

/// Settings of one Fast DDS participant.
struct FastDdsOptions {
  std::string name;                           ///< participant name, seen in DDS tools
  std::uint32_t domain = 0;                   ///< DDS domain
  std::uint32_t index = 0;                    ///< unique per domain; decides the first ports tried
  DiscoveryAddress discovery{};               ///< its server, unless it has static peers
  std::optional<StaticPeers> static_peers{};  ///< set: no discovery server is used
  std::optional<OpenDomain> open{};  ///< set: index, ports, buffers and faults have no effect
  std::string interface = "127.0.0.1";        ///< address of the interface it sends and receives on
  /// Readers of cell topics receive from one multicast group each, if the interface carries
  /// multicast. A participant with static peers that has no multicast cannot send to such readers.
  bool cells_by_multicast = true;
  bool receive_at_tick = true;  ///< no receive thread on data ports; see Participant::receive
  int receive_buffer_bytes = 4 << 20;  ///< of each socket, asked of the kernel
  ReceptionFaults faults{};            ///< simulated loss and delay of received data
  std::uint32_t port_tries = 4000;     ///< occupied ports to skip; then self_check() fails
};

/// The discovery server of a run, in the launcher's process, bound to loopback. It ends when the
/// object is destroyed.
class DiscoveryServer {
 public:
  virtual ~DiscoveryServer() = default;
  virtual DiscoveryAddress address() const = 0;
};

/// Starts a server on a free port (`port` 0) or the given one.
Result<std::unique_ptr<DiscoveryServer>> make_discovery_server(std::uint32_t domain,
                                                               std::uint16_t port);

/// Joins a run through its discovery server or with static peers. Uses UDP on one interface and no
/// shared memory. With `receive_at_tick` no thread of the vendor delivers data: samples arrive when
/// the owner calls receive().
Result<std::unique_ptr<Participant>> make_fastdds_participant(const FastDdsOptions& options);

}  // namespace swarm::link
