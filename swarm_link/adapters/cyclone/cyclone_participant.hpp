// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "swarmflow/core/result.hpp"
#include "swarm_link/port.hpp"

/// The Cyclone DDS back. No Cyclone header is needed to use it.
namespace swarm::link {

struct CycloneOptions {
  std::string name;  ///< participant name, seen in DDS tools
  std::uint32_t domain = 0;
  std::uint32_t ownership_strength = 0;  ///< of exclusive writers
  /// Ports of a host where others listen for announcements. It announces itself there and nowhere
  /// else, so that it learns of them alone; empty: to all, by multicast.
  std::vector<std::uint16_t> peer_ports{};
  std::string peer_host = "127.0.0.1";
  /// Decides the port it listens at for announcements, as announcement_port() tells; empty: any.
  std::optional<std::uint32_t> index{};
  std::string interface = "127.0.0.1";  ///< address of the interface it speaks on
};

/// Joins a domain. All participants of a process in a domain must have the same index, peers and
/// interface. Cyclone's own threads receive; take() hands over what they have.
Result<std::unique_ptr<Participant>> make_cyclone_participant(const CycloneOptions& options);

}  // namespace swarm::link
