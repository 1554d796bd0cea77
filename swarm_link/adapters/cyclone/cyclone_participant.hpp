// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "swarm_link/port.hpp"
#include "swarmflow/core/result.hpp"

/// The Cyclone DDS adapter. No Cyclone header is needed to use it.
namespace swarm::link {

/// Settings of one Cyclone DDS participant.
struct CycloneOptions {
  std::string name;          ///< participant name, seen in DDS tools
  std::uint32_t domain = 0;  ///< DDS domain
  /// Announcement ports of the static peers on `peer_host`. The participant announces itself to
  /// these ports only, so it discovers these peers only. Empty: it announces itself by multicast to
  /// all.
  std::vector<std::uint16_t> peer_ports{};
  std::string peer_host = "127.0.0.1";  ///< address of the static peers
  /// Decides at which port the participant receives announcements: announcement_port(). Empty: the
  /// kernel chooses a free port.
  std::optional<std::uint32_t> index{};
  /// Address of the interface it sends and receives on; empty: the one that Cyclone chooses.
  std::string interface = "127.0.0.1";
  /// Addresses to which it announces itself beside multicast, where programs of others use the
  /// domain.
  std::vector<std::string> open_peers{};
  std::string user_data{};  ///< announced with the participant
};

/// Joins a domain. All participants of a process in one domain must have the same index, peers and
/// interface, because Cyclone configures a domain once per process. Cyclone's own threads receive;
/// take() hands over the samples they have stored. Fails when the interface or the domain is not
/// usable.
Result<std::unique_ptr<Participant>> make_cyclone_participant(const CycloneOptions& options);

}  // namespace swarm::link
