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

/// The bus as the programs see it: writers and readers made by a participant. Three backs implement
/// it, on bytes: fastdds/, cyclone/ and inproc/. No vendor type and no vendor exception crosses
/// this line, and no vendor thread ever runs domain code: readers are polled.
namespace swarm::link {

/// A process's presence on the bus. Makes endpoints; outlives them all.
class Participant {
 public:
  virtual ~Participant() = default;

  virtual Result<RawWriterPtr> make_writer(const RawTopic& topic) = 0;
  virtual Result<RawReaderPtr> make_reader(const RawTopic& topic) = 0;

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
  /// the start of a tick, before take(). Does nothing in backs that receive in threads of their
  /// own.
  virtual void receive() = 0;

  /// Fails, saying why and how to mend it, when this participant could not hear its peers: no
  /// listening port, or receive buffers far below what was asked for. Call it once after making.
  virtual Result<void> self_check() const = 0;
};

}  // namespace swarm::link
