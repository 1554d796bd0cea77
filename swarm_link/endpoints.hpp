// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/raw_port.hpp"

/// Typed writers and readers: they encode and decode, and use a RawWriter or RawReader of any
/// backend.
namespace swarm::link {

/// Sends messages of one topic, as RawWriter.
template <class M>
class Writer {
 public:
  virtual ~Writer() = default;
  /// False when a sequence exceeds its bound or the backend refused the message; never throws.
  virtual bool write(const M& message) = 0;
  /// Readers this writer is matched with at the moment.
  virtual int matched() const = 0;
};

/// Receives messages of one topic. Not thread-safe.
template <class M>
class Reader {
 public:
  virtual ~Reader() = default;
  /// Appends every message that arrived since the last call, oldest first, and returns their
  /// number. Samples that cannot be decoded are dropped and counted in undecodable().
  virtual std::size_t take(std::vector<M>& out) = 0;
  /// As take(); also appends the RawSample::sender of every message.
  virtual std::size_t take_with_senders(std::vector<M>& out, std::vector<std::uint64_t>& senders) {
    const std::size_t taken = take(out);
    senders.resize(senders.size() + taken, 0);
    return taken;
  }
  virtual int matched() const = 0;
  /// Samples dropped since the start because they could not be decoded.
  virtual std::uint64_t undecodable() const = 0;
};

template <class M>
using WriterPtr = std::unique_ptr<Writer<M>>;
template <class M>
using ReaderPtr = std::unique_ptr<Reader<M>>;

/// Encodes messages and writes their bytes.
template <Message M>
class EncodingWriter final : public Writer<M> {
 public:
  explicit EncodingWriter(RawWriterPtr raw) : raw_(std::move(raw)) {}
  bool write(const M& message) override { return encode(message, bytes_) && raw_->write(bytes_); }
  int matched() const override { return raw_->matched(); }

 private:
  RawWriterPtr raw_;              ///< of the backend
  std::vector<std::byte> bytes_;  // reused between messages
};

/// Takes bytes and decodes them. The content is not checked here; that is the Gate's.
template <Message M>
class DecodingReader final : public Reader<M> {
 public:
  explicit DecodingReader(RawReaderPtr raw) : raw_(std::move(raw)) {}

  std::size_t take(std::vector<M>& out) override {
    const std::size_t before = out.size();
    raw_->take([this, &out](const RawSample& sample) { append(sample, out); });
    return out.size() - before;
  }
  std::size_t take_with_senders(std::vector<M>& out, std::vector<std::uint64_t>& senders) override {
    const std::size_t before = out.size();
    raw_->take([this, &out, &senders](const RawSample& sample) {
      if (append(sample, out)) senders.push_back(sample.sender);
    });
    return out.size() - before;
  }
  int matched() const override { return raw_->matched(); }
  std::uint64_t undecodable() const override { return undecodable_; }

 private:
  bool append(const RawSample& sample, std::vector<M>& out) {
    if (decode(sample.bytes, out.emplace_back())) return true;
    out.pop_back();
    ++undecodable_;
    return false;
  }

  RawReaderPtr raw_;               ///< of the backend
  std::uint64_t undecodable_ = 0;  ///< since the start
};

}  // namespace swarm::link
