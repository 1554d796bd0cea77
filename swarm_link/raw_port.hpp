// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "swarmflow/core/result.hpp"
#include "swarm_link/topics.hpp"

/// The bus for those who look on: samples as they are on the wire, of any type, not decoded.
namespace swarm::link {

struct RawTopic {
  std::string name{};
  std::string type{};  ///< "swarm::wire::FlowPlan"
  Qos qos{};
  bool keyed = false;  ///< by its first member, an unsigned long
};

struct RawMessage {
  std::vector<std::byte> bytes{};  ///< CDR with its encapsulation
  std::int64_t said_utc_ns = 0;    ///< by its writer's clock
};

class RawWriter {
 public:
  virtual ~RawWriter() = default;
  virtual bool write(const RawMessage& message) = 0;
  virtual int matched() const = 0;
};

class RawReader {
 public:
  virtual ~RawReader() = default;
  /// Appends what came since the last call, oldest first.
  virtual std::size_t take(std::vector<RawMessage>& out) = 0;
  virtual int matched() const = 0;
};

/// As Participant; not to be mixed with one's types.
class RawParticipant {
 public:
  virtual ~RawParticipant() = default;
  virtual Result<std::unique_ptr<RawWriter>> make_writer(const RawTopic& topic) = 0;
  virtual Result<std::unique_ptr<RawReader>> make_reader(const RawTopic& topic) = 0;
  virtual void receive() = 0;
};

}  // namespace swarm::link
