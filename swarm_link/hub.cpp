// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/hub.hpp"

#include <utility>

#include "swarm_core/base/assert.hpp"
#include "swarm_link/typed_participant.hpp"

namespace swarm::link {
namespace {

template <class M>
class HubWriter final : public Writer<M> {
 public:
  explicit HubWriter(std::vector<WriterPtr<M>> writers) : writers_(std::move(writers)) {}

  bool write(const M& message) override {
    bool all = true;
    for (const WriterPtr<M>& writer : writers_) all = writer->write(message) && all;
    return all;
  }

  int matched() const override {
    int matched = 0;
    for (const WriterPtr<M>& writer : writers_) matched += writer->matched();
    return matched;
  }

 private:
  std::vector<WriterPtr<M>> writers_;
};

template <class M>
class HubReader final : public Reader<M> {
 public:
  explicit HubReader(std::vector<ReaderPtr<M>> readers) : readers_(std::move(readers)) {}

  std::size_t take(std::vector<M>& out) override {
    std::size_t taken = 0;
    for (const ReaderPtr<M>& reader : readers_) taken += reader->take(out);
    return taken;
  }

  int matched() const override {
    int matched = 0;
    for (const ReaderPtr<M>& reader : readers_) matched += reader->matched();
    return matched;
  }

  std::uint64_t undecodable() const override {
    std::uint64_t undecodable = 0;
    for (const ReaderPtr<M>& reader : readers_) undecodable += reader->undecodable();
    return undecodable;
  }

 private:
  std::vector<ReaderPtr<M>> readers_;
};

class Hub final : public TypedParticipant<Hub> {
 public:
  explicit Hub(std::vector<std::unique_ptr<Participant>> participants)
      : participants_(std::move(participants)) {}

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
  friend class TypedParticipant<Hub>;
  template <class M>
  Result<WriterPtr<M>> writer(const Topic<M>& topic) {
    std::vector<WriterPtr<M>> writers;
    for (const auto& participant : participants_) {
      auto made = participant->make_writer(topic);
      if (!made) return made;
      writers.push_back(std::move(*made));
    }
    return std::make_unique<HubWriter<M>>(std::move(writers));
  }

  template <class M>
  Result<ReaderPtr<M>> reader(const Topic<M>& topic) {
    std::vector<ReaderPtr<M>> readers;
    for (const auto& participant : participants_) {
      auto made = participant->make_reader(topic);
      if (!made) return made;
      readers.push_back(std::move(*made));
    }
    return std::make_unique<HubReader<M>>(std::move(readers));
  }

  std::vector<std::unique_ptr<Participant>> participants_;
};

}  // namespace

std::unique_ptr<Participant> make_hub(std::vector<std::unique_ptr<Participant>> participants) {
  SWARM_ASSERT(!participants.empty());
  if (participants.size() == 1) return std::move(participants.front());
  return std::make_unique<Hub>(std::move(participants));
}

}  // namespace swarm::link
