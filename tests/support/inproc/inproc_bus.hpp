// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "swarm_link/port.hpp"

/// The in-process backend: a bus in memory with the semantics of the DDS adapters (keep-last
/// histories, transient-local), deterministic and without threads.
namespace swarm::link {

/// Owns the channels of all topics. Participants of one bus communicate; two buses are separate.
/// Not thread-safe.
class InprocBus {
 public:
  InprocBus();
  ~InprocBus();
  InprocBus(const InprocBus&) = delete;
  InprocBus& operator=(const InprocBus&) = delete;

  /// \pre the bus outlives the participant
  std::unique_ptr<Participant> make_participant();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swarm::link
