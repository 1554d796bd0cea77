// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"
#include "swarm_link/channels/state_channel.hpp"
#include "swarm_link/port.hpp"

/// The buses under test: each backend behind the same few functions.
namespace swarm::link::conformance {

class Bus {
 public:
  virtual ~Bus() = default;

  /// A new participant, valid as long as the bus.
  Participant& participant();

  /// A state channel, over a participant of its own.
  virtual std::unique_ptr<StateChannel> channel(const CellOptions& options);

  /// One tick of all participants.
  void pump();

  /// Ticks until the condition holds. The deadline only protects against an endless loop.
  template <class Condition>
  bool eventually(Condition condition) {
    for (const Hang guard; !guard.over(); rest()) {
      pump();
      if (condition()) return true;
    }
    return false;
  }

  /// Ticks for some time, for tests that something does not arrive. A period that is too short can
  /// only hide a fault.
  void converge();

 protected:
  virtual std::unique_ptr<Participant> make() = 0;

 private:
  class Hang {
   public:
    Hang();
    bool over() const;

   private:
    std::int64_t deadline_ns_;
  };
  static void rest();

  std::vector<std::unique_ptr<Participant>> participants_;
};

/// DDS domain of this test process, so that test processes that run at the same time do not receive
/// each other. Low enough for the ports to stay below the kernel's ephemeral ones.
std::uint32_t test_domain();

std::unique_ptr<Bus> make_inproc_bus();
std::unique_ptr<Bus> make_fastdds_bus(bool receive_at_tick = true);

/// A bus on a discovery server that the caller runs.
std::unique_ptr<Bus> join_fastdds_bus(const DiscoveryAddress& discovery, std::uint32_t first_index);

using MakeBus = std::unique_ptr<Bus> (*)();
struct Backend {
  const char* name;
  MakeBus make;
};
const std::vector<Backend>& backends();
/// The backends, whose channels use topics, and the groups.
const std::vector<Backend>& channel_backends();
inline std::string name_of(const testing::TestParamInfo<Backend>& back) { return back.param.name; }

}  // namespace swarm::link::conformance
