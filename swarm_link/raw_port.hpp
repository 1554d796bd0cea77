// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "swarm_link/cdr/layout.hpp"
#include "swarm_link/topics.hpp"

/// The interface of a backend: samples as bytes of any type. Monitors use it directly.
namespace swarm::link {

/// Name, type and QoS of a topic, without the message type.
struct RawTopic {
  std::string name{};                   ///< "swarm/plan"
  std::string type{};                   ///< "swarm::wire::FlowPlan"
  Qos qos{};                            ///< requested by readers, offered by writers
  bool keyed = false;                   ///< the first member, an unsigned long, is the key
  std::size_t usual_bytes = 1U << 16U;  ///< initial buffer size; larger samples pass as well
};

/// The raw topic of a message type.
template <Message M>
RawTopic raw_topic(const Topic<M>& topic) {
  return {.name = topic.name,
          .type = type_name<M>(),
          .qos = topic.qos,
          .keyed = keyed<M>(),
          .usual_bytes = cdr::kEncapsulationBytes + cdr::most_bytes<M>()};
}

/// A received sample; its bytes are valid during the call.
struct RawSample {
  std::span<const std::byte> bytes{};  ///< CDR with its encapsulation
  std::int64_t published_utc_ns = 0;   ///< by the writer's clock; 0 if the backend has none
  std::uint64_t sender = 0;            ///< participant of the writer, on all topics; 0: unknown
};

/// A received sample that owns its bytes.
struct RawMessage {
  std::vector<std::byte> bytes{};
  std::int64_t sent_utc_ns = 0;
};

/// Sends samples of one topic. Its destruction unregisters the writer. Not thread-safe; write() may
/// block for microseconds (socket send), never for a peer.
class RawWriter {
 public:
  virtual ~RawWriter() = default;
  /// False when the backend refused the sample; never throws.
  virtual bool write(std::span<const std::byte> bytes) = 0;
  /// Readers this writer is matched with at the moment.
  virtual int matched() const = 0;
};

/// Receives samples of one topic. Not thread-safe.
class RawReader {
 public:
  using Sink = std::function<void(const RawSample&)>;

  virtual ~RawReader() = default;
  /// Hands over every sample that arrived since the last call, oldest first; returns how many.
  virtual std::size_t take(const Sink& sink) = 0;
  virtual int matched() const = 0;

  /// The same, with copies appended to `out`.
  std::size_t take(std::vector<RawMessage>& out) {
    return take([&out](const RawSample& sample) {
      out.push_back({.bytes = {sample.bytes.begin(), sample.bytes.end()},
                     .sent_utc_ns = sample.published_utc_ns});
    });
  }
};

using RawWriterPtr = std::unique_ptr<RawWriter>;
using RawReaderPtr = std::unique_ptr<RawReader>;

}  // namespace swarm::link
