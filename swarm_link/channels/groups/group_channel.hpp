// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "swarm_link/channels/cell.hpp"
#include "swarm_link/channels/faulty_path.hpp"
#include "swarm_link/channels/state_channel.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::link {

/// Multicast address of the states of a cell, for tools that observe the network. Cells may share a
/// group, which costs additional datagrams but is not an error; any two cells at most 181 columns
/// and 179 rows apart have different groups.
struct GroupAddress {
  std::string host;        ///< 239.255.h.h
  std::uint16_t port = 0;  ///< the same for all groups of a domain
};
/// The group of a cell in a DDS domain.
GroupAddress group_address(std::uint32_t domain, Cell cell);

/// Settings of a `groups` channel.
struct GroupChannelOptions {
  std::uint32_t domain = 0;  ///< groups of different domains have different ports
  CellOptions cells{.cell_size_m = 5.0, .join_margin_m = 0.5, .leave_margin_m = 1.5};
  int receive_buffer_bytes = 1 << 20;   ///< per cell that is received
  std::string interface = "127.0.0.1";  ///< address of the interface it sends and receives on
  ReceptionFaults faults{};             ///< simulated loss and delay
};

/// The `groups` channel: it sends the samples of the cell topics as RTPS messages, but each cell is
/// a multicast group, which a process joins and leaves by a system call, without endpoint
/// discovery. It is for hundreds of one-robot processes, whose endpoints could not be discovered in
/// time. There is no matching, no QoS check and no DDS Security: the Gate checks every state, and
/// the groups must be reachable by trusted processes only.
///
/// take() drains the sockets itself, in the caller's thread. Fails when the interface carries no
/// multicast.
Result<std::unique_ptr<StateChannel>> make_group_channel(const GroupChannelOptions& options);

}  // namespace swarm::link
