// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "swarmflow/core/result.hpp"
#include "swarm_link/messages.hpp"
#include "swarm_link/topics.hpp"

/// The bus as the programs see it: typed writers and readers made by a participant. Three backs
/// implement it: fastdds/, cyclone/ and inproc/. No vendor type and no vendor exception
/// crosses this line, and no vendor thread ever runs domain code: readers are polled.
namespace swarm::link {

/// Sends messages of one topic. Destroying it unregisters the writer.
/// Not thread-safe; may block for microseconds (socket send), never for a peer.
template <class M>
class Writer {
 public:
  virtual ~Writer() = default;
  /// False when the back refused the sample (counted there); never throws.
  virtual bool write(const M& message) = 0;
  /// Readers this writer is matched with at the moment.
  virtual int matched() const = 0;
};

/// Receives messages of one topic. Not thread-safe.
template <class M>
class Reader {
 public:
  virtual ~Reader() = default;
  /// Appends every message that arrived since the last call, oldest first; returns how many.
  /// Samples that do not decode are dropped and counted in undecodable().
  virtual std::size_t take(std::vector<M>& out) = 0;
  virtual int matched() const = 0;
  virtual std::uint64_t undecodable() const = 0;
};

template <class M>
using WriterPtr = std::unique_ptr<Writer<M>>;
template <class M>
using ReaderPtr = std::unique_ptr<Reader<M>>;

/// A process's presence on the bus. Makes endpoints; outlives them all.
class Participant {
 public:
  virtual ~Participant() = default;

  virtual Result<WriterPtr<PlanMessage>> make_writer(const Topic<PlanMessage>&) = 0;
  virtual Result<WriterPtr<SceneMessage>> make_writer(const Topic<SceneMessage>&) = 0;
  virtual Result<WriterPtr<HeartbeatMessage>> make_writer(const Topic<HeartbeatMessage>&) = 0;
  virtual Result<WriterPtr<CellStatesMessage>> make_writer(const Topic<CellStatesMessage>&) = 0;
  virtual Result<WriterPtr<CommandMessage>> make_writer(const Topic<CommandMessage>&) = 0;
  virtual Result<WriterPtr<StatusMessage>> make_writer(const Topic<StatusMessage>&) = 0;
  virtual Result<WriterPtr<EventMessage>> make_writer(const Topic<EventMessage>&) = 0;

  virtual Result<ReaderPtr<PlanMessage>> make_reader(const Topic<PlanMessage>&) = 0;
  virtual Result<ReaderPtr<SceneMessage>> make_reader(const Topic<SceneMessage>&) = 0;
  virtual Result<ReaderPtr<HeartbeatMessage>> make_reader(const Topic<HeartbeatMessage>&) = 0;
  virtual Result<ReaderPtr<CellStatesMessage>> make_reader(const Topic<CellStatesMessage>&) = 0;
  virtual Result<ReaderPtr<CommandMessage>> make_reader(const Topic<CommandMessage>&) = 0;
  virtual Result<ReaderPtr<StatusMessage>> make_reader(const Topic<StatusMessage>&) = 0;
  virtual Result<ReaderPtr<EventMessage>> make_reader(const Topic<EventMessage>&) = 0;

  /// Hands everything that waits in the sockets to the readers, in the caller's thread. Call it at
  /// the start of a tick, before take(). Does nothing in backs that receive in threads of their
  /// own.
  virtual void receive() = 0;

  /// Fails, saying why and how to mend it, when this participant could not hear its peers: no
  /// listening port, or receive buffers far below what was asked for. Call it once after making.
  virtual Result<void> self_check() const = 0;
};

}  // namespace swarm::link
