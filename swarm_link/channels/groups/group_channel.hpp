// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "swarmflow/core/result.hpp"
#include "swarm_link/channels/cell.hpp"
#include "swarm_link/channels/faulty_path.hpp"
#include "swarm_link/channels/state_channel.hpp"

namespace swarm::link {

/// Where the states of a cell go, for tools that watch the network. Cells may share a group, which
/// costs datagrams, not correctness; any two up to 181 × 179 cells apart do not.
struct GroupAddress {
  std::string host;  ///< 239.255.h.h
  std::uint16_t port = 0;
};
GroupAddress group_address(std::uint32_t domain, Cell cell);

struct GroupChannelOptions {
  std::uint32_t domain = 0;  ///< groups of different domains do not hear each other
  CellOptions cells{.cell_size_m = 5.0, .join_margin_m = 0.5, .leave_margin_m = 1.5};
  int receive_buffer_bytes = 1 << 20;   ///< per cell that is received
  std::string interface = "127.0.0.1";  ///< address of the interface it hears and speaks on
  ReceptionFaults faults{};
};

/// The `groups` channel: the samples of the cell topics as RTPS messages, but a cell is a multicast
/// group that is joined and left by a system call, without endpoint discovery. For hundreds of
/// one-robot processes, whose endpoints nobody could discover in time. No match, no QoS check, no
/// DDS Security: everything is checked by the input validation, and only trusted processes may reach the
/// groups.
///
/// take() empties the sockets itself. Fails when the interface carries no multicast.
Result<std::unique_ptr<StateChannel>> make_group_channel(const GroupChannelOptions& options);

}  // namespace swarm::link
