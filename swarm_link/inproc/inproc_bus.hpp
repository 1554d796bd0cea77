// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "swarm_link/port.hpp"

/// The in-process back: a bus in memory with the semantics of the DDS backs (keep-last histories,
/// transient-local, exclusive ownership), deterministic, without threads. For tests and lock-step.
namespace swarm::link {

class InprocBus {
 public:
  InprocBus();
  ~InprocBus();
  InprocBus(const InprocBus&) = delete;
  InprocBus& operator=(const InprocBus&) = delete;

  /// \pre the bus outlives the participant
  std::unique_ptr<Participant> make_participant(std::uint32_t ownership_strength = 0);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swarm::link
