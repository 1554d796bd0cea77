// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "swarm_link/raw_port.hpp"

namespace swarm::link::inproc {

/// A sample, shared by all histories that store it. Histories are per instance.
struct Sample {
  std::shared_ptr<const std::vector<std::byte>> bytes;
  std::uint32_t instance = 0;  ///< value of the key; 0 if the topic has none
  std::uint64_t sender = 0;    ///< number of the writer's participant, from 1
};

/// The key of a keyed topic: its first member. \pre the bytes are little-endian, as our encoder's
/// are
inline std::uint32_t instance_of(std::span<const std::byte> bytes) {
  std::uint32_t key = 0;
  std::memcpy(&key, bytes.data() + cdr::kEncapsulationBytes, sizeof key);
  return key;
}

/// Keep-last history: at most `depth` samples per instance, oldest first.
class History {
 public:
  explicit History(int depth) : depth_(depth) {}

  /// Appends a sample; the oldest of the same instance is dropped when there are `depth` of them.
  void push(Sample sample) {
    auto& count = counts_[sample.instance];
    if (count == depth_) {
      samples_.erase(std::find_if(samples_.begin(), samples_.end(), [&](const Sample& kept) {
        return kept.instance == sample.instance;
      }));
      --count;
    }
    samples_.push_back(std::move(sample));
    ++count;
  }

  /// Passes all samples to the sink and empties the history first, so that the sink may cause new
  /// samples.
  std::size_t hand_over(const RawReader::Sink& sink) {
    counts_.clear();
    const std::deque<Sample> all = std::exchange(samples_, {});
    for (const Sample& sample : all) sink({.bytes = *sample.bytes, .sender = sample.sender});
    return all.size();
  }

  const std::deque<Sample>& samples() const { return samples_; }

 private:
  int depth_;                            ///< per instance
  std::deque<Sample> samples_;           ///< of all instances, oldest first
  std::map<std::uint32_t, int> counts_;  ///< samples by instance
};

class InprocWriter;
class InprocReader;

/// All endpoints of one topic, in the order they were created. Endpoints register themselves.
struct Channel {
  std::vector<InprocWriter*> writers;
  std::vector<InprocReader*> readers;
};

/// The matching rule of DDS: the writer offers at least what the reader requests.
inline bool compatible(const Qos& offered, const Qos& asked) {
  return (offered.reliability == Reliability::kReliable ||
          asked.reliability == Reliability::kBestEffort) &&
         (offered.durability == Durability::kTransientLocal ||
          asked.durability == Durability::kVolatile);
}

/// Stores delivered samples until they are taken. A transient-local reader first receives the
/// histories of the existing writers.
class InprocReader final : public RawReader {
 public:
  InprocReader(std::shared_ptr<Channel> channel, const Qos& qos)
      : channel_(std::move(channel)), qos_(qos), history_(std::max(qos.depth, qos.reader_depth)) {
    channel_->readers.push_back(this);
    if (qos.durability == Durability::kTransientLocal) catch_up();
  }
  ~InprocReader() override { std::erase(channel_->readers, this); }

  /// Hands over what was delivered since the last call.
  std::size_t take(const Sink& sink) override { return history_.hand_over(sink); }

  int matched() const override;

  const Qos& qos() const { return qos_; }

  /// Stores a sample if the QoS allow it.
  void deliver(const InprocWriter& from, const Sample& sample);

 private:
  /// Delivers the histories of the transient-local writers that exist already.
  void catch_up();

  std::shared_ptr<Channel> channel_;
  Qos qos_;
  History history_;
};

/// Delivers to all readers of its topic within write(), in the caller's thread.
class InprocWriter final : public RawWriter {
 public:
  /// `sender`: number of its participant
  InprocWriter(std::shared_ptr<Channel> channel, const RawTopic& topic, std::uint64_t sender)
      : channel_(std::move(channel)),
        qos_(topic.qos),
        keyed_(topic.keyed),
        sender_(sender),
        history_(topic.qos.depth) {
    channel_->writers.push_back(this);
  }
  ~InprocWriter() override { std::erase(channel_->writers, this); }

  /// False only for bytes without encapsulation or key.
  bool write(std::span<const std::byte> bytes) override;
  int matched() const override;

  const Qos& qos() const { return qos_; }
  /// What a late transient-local reader receives.
  const std::deque<Sample>& history() const { return history_.samples(); }

 private:
  std::shared_ptr<Channel> channel_;
  Qos qos_;
  bool keyed_;
  std::uint64_t sender_;
  History history_;  ///< of a transient-local writer, for late readers
};

}  // namespace swarm::link::inproc
