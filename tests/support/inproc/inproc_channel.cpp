// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/inproc/inproc_channel.hpp"

namespace swarm::link::inproc {

void InprocReader::deliver(const InprocWriter& from, const Sample& sample) {
  if (compatible(from.qos(), qos_)) history_.push(sample);
}

int InprocReader::matched() const {
  return static_cast<int>(
      std::count_if(channel_->writers.begin(), channel_->writers.end(),
                    [&](const InprocWriter* writer) { return compatible(writer->qos(), qos_); }));
}

void InprocReader::catch_up() {
  for (const auto* writer : channel_->writers) {
    if (writer->qos().durability != Durability::kTransientLocal) continue;
    for (const Sample& sample : writer->history()) deliver(*writer, sample);
  }
}

// The bytes are copied once and shared by all readers and the history.
bool InprocWriter::write(std::span<const std::byte> bytes) {
  if (bytes.size() < cdr::kEncapsulationBytes + (keyed_ ? sizeof(std::uint32_t) : 0)) return false;
  Sample sample{.bytes = std::make_shared<std::vector<std::byte>>(bytes.begin(), bytes.end()),
                .instance = keyed_ ? instance_of(bytes) : 0,
                .sender = sender_};
  for (auto* reader : channel_->readers) reader->deliver(*this, sample);
  if (qos_.durability == Durability::kTransientLocal) history_.push(std::move(sample));
  return true;
}

int InprocWriter::matched() const {
  return static_cast<int>(
      std::count_if(channel_->readers.begin(), channel_->readers.end(),
                    [&](const InprocReader* reader) { return compatible(qos_, reader->qos()); }));
}

}  // namespace swarm::link::inproc
