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

/// The Fast DDS back. This header is vendor-free; the vendor's headers stay inside this folder.
namespace swarm::link {

/// Where a run's discovery server listens (loopback unless told otherwise).
struct DiscoveryAddress {
  std::string host = "127.0.0.1";
  std::uint16_t port = 0;
};

/// Discovery without a server: a participant announces itself to a few others, who answer, and to
/// nobody else.
struct StaticPeers {
  bool is_relay = false;  ///< others know its port: it listens at that of its index, or is of no use
  std::vector<std::uint32_t> peers{};  ///< indices of the hubs to announce itself to
  std::string host = "127.0.0.1";      ///< where those are
};

struct FastDdsOptions {
  std::string name;  ///< participant name, seen in DDS tools
  std::uint32_t domain = 0;
  std::uint32_t index = 0;       ///< unique per domain; decides the first ports tried
  DiscoveryAddress discovery{};  ///< the server this participant is a client of, unless in a …
  std::optional<StaticPeers> static_peers{};
  std::string interface = "127.0.0.1";  ///< address of the interface it speaks on
  /// Of exclusive writers. A stand-by planner that waits in the background has less; one that
  /// replaces another must have more: a killed writer keeps its topic until its lease ends, and an
  /// equal or weaker one goes unheard that long (measured with a lease of 15 s: 14 s, against 0.9
  /// s).
  std::uint32_t ownership_strength = 0;
  /// Readers of cells hear by a multicast group each, where the interface carries it; who joins a
  /// star without multicast cannot speak to such.
  bool cells_by_multicast = true;
  bool receive_at_tick = true;  ///< no receive thread on data ports; see Participant::receive
  int receive_buffer_bytes = 4 << 20;
  ReceptionFaults faults{};         ///< of data that is received at the tick
  std::uint32_t port_tries = 4000;  ///< occupied ports skipped before giving up (self_check tells)
};

/// Hosts the discovery server of a run; lives in the launcher's process. Bound to loopback.
class DiscoveryServer {
 public:
  virtual ~DiscoveryServer() = default;
  virtual DiscoveryAddress address() const = 0;
};

/// Starts a server on a free port (`port` 0) or the given one.
Result<std::unique_ptr<DiscoveryServer>> make_discovery_server(std::uint32_t domain,
                                                               std::uint16_t port);

/// Joins a run, by its discovery server or in a star; UDP on one interface, no shared memory.
Result<std::unique_ptr<Participant>> make_fastdds_participant(const FastDdsOptions& options);

}  // namespace swarm::link
