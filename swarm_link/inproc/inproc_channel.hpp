// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "swarm_link/port.hpp"
#include "swarm_link/wire_bounds.hpp"

namespace swarm::link::inproc {

/// Instance a message belongs to: histories and ownership are kept per instance.
template <class M>
std::uint32_t instance_of(const M&) {
  return 0;
}
inline std::uint32_t instance_of(const StatusMessage& m) { return m.first_robot_id; }

/// Keep-last history: at most `depth` messages per instance, oldest first.
template <class M>
class History {
 public:
  explicit History(int depth) : depth_(depth) {}

  void push(M message) {
    const auto instance = instance_of(message);
    auto& count = counts_[instance];
    if (count == depth_) {
      messages_.erase(std::find_if(messages_.begin(), messages_.end(),
                                   [&](const M& kept) { return instance_of(kept) == instance; }));
      --count;
    }
    messages_.push_back(std::move(message));
    ++count;
  }

  std::size_t move_to(std::vector<M>& out) {
    const auto size = messages_.size();
    std::move(messages_.begin(), messages_.end(), std::back_inserter(out));
    messages_.clear();
    counts_.clear();
    return size;
  }

  const std::deque<M>& messages() const { return messages_; }

 private:
  int depth_;
  std::deque<M> messages_;
  std::map<std::uint32_t, int> counts_;
};

template <class M>
class InprocWriter;
template <class M>
class InprocReader;

/// All endpoints of one topic, in order of their making.
template <class M>
struct Channel {
  std::vector<InprocWriter<M>*> writers;
  std::vector<InprocReader<M>*> readers;
};

/// DDS's rule: the writer offers at least what the reader asks for.
inline bool compatible(const Qos& offered, const Qos& asked) {
  return offered.ownership == asked.ownership &&
         (offered.reliability == Reliability::kReliable ||
          asked.reliability == Reliability::kBestEffort) &&
         (offered.durability == Durability::kTransientLocal ||
          asked.durability == Durability::kVolatile);
}

template <class M>
class InprocReader final : public Reader<M> {
 public:
  InprocReader(std::shared_ptr<Channel<M>> channel, const Qos& qos)
      : channel_(std::move(channel)), qos_(qos), history_(qos.depth) {
    channel_->readers.push_back(this);
    if (qos.durability == Durability::kTransientLocal) catch_up();
  }
  ~InprocReader() override { std::erase(channel_->readers, this); }

  std::size_t take(std::vector<M>& out) override { return history_.move_to(out); }

  int matched() const override {
    return static_cast<int>(std::count_if(
        channel_->writers.begin(), channel_->writers.end(),
        [&](const InprocWriter<M>* writer) { return compatible(writer->qos(), qos_); }));
  }

  std::uint64_t undecodable() const override { return 0; }

  const Qos& qos() const { return qos_; }

  void deliver(const InprocWriter<M>& from, const M& message) {
    if (!compatible(from.qos(), qos_)) return;
    if (qos_.ownership == Ownership::kExclusive) {
      auto& owner = owners_[instance_of(message)];
      if (owner != nullptr && owner != &from && from.strength() <= owner->strength()) return;
      owner = &from;
    }
    history_.push(message);
  }

  void writer_gone(const InprocWriter<M>& writer) {
    std::erase_if(owners_, [&](const auto& entry) { return entry.second == &writer; });
  }

 private:
  // Strongest writer first, so that with exclusive ownership the others stay silent.
  void catch_up() {
    auto writers = channel_->writers;
    std::stable_sort(writers.begin(), writers.end(),
                     [](const auto* a, const auto* b) { return a->strength() > b->strength(); });
    for (const auto* writer : writers) {
      if (writer->qos().durability != Durability::kTransientLocal) continue;
      for (const auto& message : writer->history()) deliver(*writer, message);
    }
  }

  std::shared_ptr<Channel<M>> channel_;
  Qos qos_;
  History<M> history_;
  std::map<std::uint32_t, const InprocWriter<M>*> owners_;
};

template <class M>
class InprocWriter final : public Writer<M> {
 public:
  InprocWriter(std::shared_ptr<Channel<M>> channel, const Qos& qos, std::uint32_t strength)
      : channel_(std::move(channel)), qos_(qos), strength_(strength), history_(qos.depth) {
    channel_->writers.push_back(this);
  }
  ~InprocWriter() override {
    std::erase(channel_->writers, this);
    for (auto* reader : channel_->readers) reader->writer_gone(*this);
  }

  bool write(const M& message) override {
    if (!fits_wire(message)) return false;
    M copy = message;
    cut_strings(copy);
    for (auto* reader : channel_->readers) reader->deliver(*this, copy);
    if (qos_.durability == Durability::kTransientLocal) history_.push(std::move(copy));
    return true;
  }

  int matched() const override {
    return static_cast<int>(std::count_if(
        channel_->readers.begin(), channel_->readers.end(),
        [&](const InprocReader<M>* reader) { return compatible(qos_, reader->qos()); }));
  }

  const Qos& qos() const { return qos_; }
  std::uint32_t strength() const { return strength_; }
  const std::deque<M>& history() const { return history_.messages(); }

 private:
  std::shared_ptr<Channel<M>> channel_;
  Qos qos_;
  std::uint32_t strength_;
  History<M> history_;
};

}  // namespace swarm::link::inproc
