// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/roles/relay_participant.hpp"

#include <utility>

#include "swarm_core/base/assert.hpp"

namespace swarm::link {
namespace {

// Writes to every participant. A peer is matched with one of them only, so it receives a sample
// once.
class RelayWriter final : public RawWriter {
 public:
  explicit RelayWriter(std::vector<RawWriterPtr> writers) : writers_(std::move(writers)) {}

  bool write(std::span<const std::byte> bytes) override {
    bool all = true;
    for (const RawWriterPtr& writer : writers_) all = writer->write(bytes) && all;
    return all;
  }

  int matched() const override {
    int matched = 0;
    for (const RawWriterPtr& writer : writers_) matched += writer->matched();
    return matched;
  }

 private:
  std::vector<RawWriterPtr> writers_;
};

// Takes from all participants in turn; there is no order between samples of different ones.
class RelayReader final : public RawReader {
 public:
  explicit RelayReader(std::vector<RawReaderPtr> readers) : readers_(std::move(readers)) {}

  std::size_t take(const Sink& sink) override {
    std::size_t taken = 0;
    for (const RawReaderPtr& reader : readers_) taken += reader->take(sink);
    return taken;
  }

  int matched() const override {
    int matched = 0;
    for (const RawReaderPtr& reader : readers_) matched += reader->matched();
    return matched;
  }

 private:
  std::vector<RawReaderPtr> readers_;
};

// Owns the participants; an endpoint fails when it fails in one of them.
class RelayParticipant final : public Participant {
 public:
  explicit RelayParticipant(std::vector<std::unique_ptr<Participant>> participants)
      : participants_(std::move(participants)) {}

  Result<RawWriterPtr> make_writer(const RawTopic& topic) override {
    std::vector<RawWriterPtr> writers;
    for (const auto& participant : participants_) {
      auto made = participant->make_writer(topic);
      if (!made) return made;
      writers.push_back(std::move(*made));
    }
    return std::make_unique<RelayWriter>(std::move(writers));
  }

  Result<RawReaderPtr> make_reader(const RawTopic& topic) override {
    std::vector<RawReaderPtr> readers;
    for (const auto& participant : participants_) {
      auto made = participant->make_reader(topic);
      if (!made) return made;
      readers.push_back(std::move(*made));
    }
    return std::make_unique<RelayReader>(std::move(readers));
  }

  void receive() override {
    for (const auto& participant : participants_) participant->receive();
  }

  Result<void> self_check() const override {
    for (const auto& participant : participants_) {
      if (auto checked = participant->self_check(); !checked) return checked;
    }
    return {};
  }

 private:
  std::vector<std::unique_ptr<Participant>> participants_;
};

}  // namespace

// A single participant needs no wrapper.
std::unique_ptr<Participant> make_relay_participant(
    std::vector<std::unique_ptr<Participant>> participants) {
  SWARM_ASSERT(!participants.empty());
  if (participants.size() == 1) return std::move(participants.front());
  return std::make_unique<RelayParticipant>(std::move(participants));
}

}  // namespace swarm::link
