// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"

/// A foreign peer: a plain participant of the vendor, with its own types under our type names. This
/// header is vendor-free.
namespace swarm::link::conformance {

class HostilePeer {
 public:
  HostilePeer(std::uint32_t domain, const DiscoveryAddress& discovery);
  ~HostilePeer();
  HostilePeer(const HostilePeer&) = delete;
  HostilePeer& operator=(const HostilePeer&) = delete;

  /// Writers match our readers one topic at a time; each function makes its writer at the first
  /// call and returns whether the sample was sent to a matched reader.
  bool send_batch(std::size_t states);
  bool send_plan(std::size_t nodes, std::size_t legs);
  bool send_event(std::size_t code, std::size_t text);
  bool send_lying_batch(std::uint32_t count);
  bool send_lying_plan(std::uint32_t nodes, std::uint32_t legs, std::uint32_t entries);
  bool send_lying_scene(std::uint32_t removed, std::uint32_t obstacles, std::uint32_t vertices,
                        std::uint32_t goal);
  bool send_lying_status(std::uint32_t robots, std::uint8_t arrived, std::uint32_t refused,
                         std::uint32_t state_age);
  bool send_lying_event(std::uint32_t code);
  bool send_stub_heartbeat();
  bool send_stub_command();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swarm::link::conformance
