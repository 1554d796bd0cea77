// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "swarm_link/endpoints.hpp"
#include "swarm_link/messages.hpp"
#include "swarm_link/raw_port.hpp"
#include "swarm_link/topics.hpp"
#include "swarmflow/core/result.hpp"

/// The bus as the programs use it: a participant makes writers and readers. The
/// adapters of Fast DDS and Cyclone DDS implement it, on bytes; tests have a bus in memory
/// (tests/support/inproc). No vendor type and no vendor exception passes this interface, and no
/// vendor thread runs domain code: readers are polled.
namespace swarm::link {

/// One DDS participant of a process (or several combined). It makes endpoints and must outlive
/// them. Not thread-safe.
class Participant {
 public:
  virtual ~Participant() = default;

  /// Endpoints on bytes. They fail, with the vendor's reason, when the topic exists with another
  /// type or the vendor refuses.
  virtual Result<RawWriterPtr> make_writer(const RawTopic& topic) = 0;
  virtual Result<RawReaderPtr> make_reader(const RawTopic& topic) = 0;

  /// Typed endpoints over the raw ones.
  template <Message M>
  Result<WriterPtr<M>> make_writer(const Topic<M>& topic) {
    auto raw = make_writer(raw_topic(topic));
    if (!raw) return tl::unexpected(raw.error());
    return std::make_unique<EncodingWriter<M>>(std::move(*raw));
  }
  template <Message M>
  Result<ReaderPtr<M>> make_reader(const Topic<M>& topic) {
    auto raw = make_reader(raw_topic(topic));
    if (!raw) return tl::unexpected(raw.error());
    return std::make_unique<DecodingReader<M>>(std::move(*raw));
  }

  /// Hands everything that waits in the sockets to the readers, in the caller's thread. Call it at
  /// the start of a tick, before take(). It does nothing in backends with receive threads of their
  /// own.
  virtual void receive() = 0;

  /// Fails, with the reason and a remedy, when this participant could not receive from its peers:
  /// no listening port, or receive buffers far below the requested size. Call it once after
  /// creation.
  virtual Result<void> self_check() const = 0;
};

}  // namespace swarm::link
