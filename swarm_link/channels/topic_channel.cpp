// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "swarm_link/channels/cell_traffic.hpp"
#include "swarm_link/channels/state_channel.hpp"

namespace swarm::link {

namespace {

// Writers of left cells are kept up to this number, since a robot often returns and discovering a
// new writer takes tenths of a second.
constexpr std::size_t kLingeringWriters = 8;

class TopicChannel final : public StateChannel {
 public:
  TopicChannel(Participant& participant, const CellOptions& options)
      : participant_(participant),
        options_(options),
        interest_(options),
        batches_(options.cell_size_m) {}

  std::size_t publish(std::span<const RobotStateMessage> states) override {
    std::size_t sent = 0;
    for (const CellStatesMessage& batch : batches_.sort(states, &left_)) {
      auto* writer = writer_of({batch.cell_x, batch.cell_y});
      bool is_sent = writer != nullptr && writer->write(batch);
      if (is_everywhere_ && everywhere_writer_ != nullptr) {
        is_sent = everywhere_writer_->write(batch) || is_sent;
      }
      if (is_sent) sent += count_inside(batch);
    }
    retire_writers();
    return sent;
  }

  void publish_everywhere(bool is_on) override { is_everywhere_ = is_on; }

  // Readers follow the wanted cells exactly; writers are created ahead and retired lazily.
  void listen_around(std::span<const Vec2> positions_m) override {
    ++now_;
    receives_all_ = join_everywhere();
    const auto wanted = interest_.update(positions_m);
    for (auto it = readers_.begin(); it != readers_.end();) {
      if (std::binary_search(wanted.begin(), wanted.end(), it->first)) {
        ++it;
        continue;
      }
      undecodable_of_left_ += it->second->undecodable();
      it = readers_.erase(it);
    }
    for (const Cell& cell : wanted) {
      if (readers_.contains(cell)) continue;
      auto reader = participant_.make_reader(cell_topic(cell));
      if (reader) {
        readers_.emplace(cell, *std::move(reader));
      } else {
        receives_all_ = false;
      }
    }
    // A writer is discovered some tenths of a second after its creation. It is created before the
    // robot enters the cell; otherwise its first states there would not be received.
    cells_around(positions_m, options_.join_margin_m, options_.cell_size_m, near_);
    for (const Cell& cell : near_) {
      if (writer_of(cell) == nullptr) receives_all_ = false;
    }
    retire_writers();
  }

  bool receives_at(const Vec2& position_m) const override { return interest_.covers(position_m); }
  bool receives_all() const override { return receives_all_; }

  std::size_t take(std::vector<CellStatesMessage>& out) override {
    std::size_t taken = 0;
    for (auto& [cell, reader] : readers_) taken += reader->take(out);
    if (everywhere_reader_ != nullptr) taken += everywhere_reader_->take(out);
    return taken;
  }

  std::uint64_t undecodable() const override {
    std::uint64_t sum = undecodable_of_left_;
    if (everywhere_reader_ != nullptr) sum += everywhere_reader_->undecodable();
    for (const auto& [cell, reader] : readers_) sum += reader->undecodable();
    return sum;
  }

 private:
  struct CellWriter {
    WriterPtr<CellStatesMessage> writer;
    std::uint64_t used = 0;  // value of now_
  };

  // The endpoints of the topic for all processes; false if the bus refuses one for now.
  bool join_everywhere() {
    if (everywhere_reader_ == nullptr) {
      if (auto made = participant_.make_reader(everywhere_topic())) {
        everywhere_reader_ = *std::move(made);
      }
    }
    if (everywhere_writer_ == nullptr) {
      if (auto made = participant_.make_writer(everywhere_topic())) {
        everywhere_writer_ = *std::move(made);
      }
    }
    return everywhere_reader_ != nullptr && everywhere_writer_ != nullptr;
  }

  // States of robots in the cell: the copies for cells that robots have left do not count.
  std::size_t count_inside(const CellStatesMessage& batch) const {
    const Cell cell{batch.cell_x, batch.cell_y};
    return static_cast<std::size_t>(
        std::ranges::count_if(batch.states, [&](const RobotStateMessage& state) {
          return cell_of({state.x_m, state.y_m}, options_.cell_size_m) == cell;
        }));
  }

  // The writer of a cell, created if necessary; null if the bus refuses it for now.
  Writer<CellStatesMessage>* writer_of(const Cell& cell) {
    auto it = writers_.find(cell);
    if (it == writers_.end()) {
      auto made = participant_.make_writer(cell_topic(cell));
      if (!made) return nullptr;
      it = writers_.emplace(cell, CellWriter{*std::move(made)}).first;
    }
    it->second.used = now_;
    return it->second.writer.get();
  }

  // Deletes the least recently used writers, but none that was used since the last listen_around().
  void retire_writers() {
    while (writers_.size() > kLingeringWriters) {
      const auto oldest = std::min_element(
          writers_.begin(), writers_.end(),
          [](const auto& a, const auto& b) { return a.second.used < b.second.used; });
      if (oldest->second.used == now_) return;
      writers_.erase(oldest);
    }
  }

  Participant& participant_;
  CellOptions options_;
  CellInterest interest_;
  CellBatches batches_;
  LeftCells left_;
  bool receives_all_ = true;
  bool is_everywhere_ = false;
  ReaderPtr<CellStatesMessage> everywhere_reader_;
  WriterPtr<CellStatesMessage> everywhere_writer_;
  std::uint64_t now_ = 0;  // calls of listen_around()
  std::map<Cell, ReaderPtr<CellStatesMessage>> readers_;
  std::map<Cell, CellWriter> writers_;
  std::vector<Cell> near_;  // reused
  std::uint64_t undecodable_of_left_ = 0;
};

}  // namespace

std::unique_ptr<StateChannel> make_topic_channel(Participant& participant,
                                                 const CellOptions& options) {
  return std::make_unique<TopicChannel>(participant, options);
}

}  // namespace swarm::link
