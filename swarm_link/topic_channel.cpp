// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "swarm_core/base/assert.hpp"
#include "swarm_link/state_channel.hpp"

namespace swarm::link {

namespace {

constexpr std::size_t kLingeringWriters = 8;

class TopicChannel final : public StateChannel {
 public:
  TopicChannel(Participant& participant, const CellOptions& options)
      : participant_(participant), options_(options) {
    SWARM_ASSERT(options.cell_size_m > 0.0 && options.hear_radius_m >= 0.0);
    SWARM_ASSERT(0.0 <= options.join_margin_m && options.join_margin_m <= options.leave_margin_m);
  }

  std::size_t publish(std::span<const RobotStateMessage> states) override {
    std::map<Cell, std::vector<RobotStateMessage>> by_cell;
    for (const auto& state : states) {
      by_cell[cell_of({state.x_m, state.y_m}, options_.cell_size_m)].push_back(state);
    }
    std::size_t sent = 0;
    for (const auto& [cell, in_cell] : by_cell) sent += publish_cell(cell, in_cell);
    retire_writers();
    return sent;
  }

  void listen_around(std::span<const Vec2> positions_m) override {
    ++now_;
    std::set<Cell> join;
    std::set<Cell> keep;
    std::set<Cell> speak;
    for (const auto& position : positions_m) {
      add_cells(position, options_.hear_radius_m + options_.join_margin_m, join);
      add_cells(position, options_.hear_radius_m + options_.leave_margin_m, keep);
      add_cells(position, options_.join_margin_m, speak);
    }
    for (auto it = readers_.begin(); it != readers_.end();) {
      if (keep.contains(it->first)) {
        ++it;
        continue;
      }
      undecodable_of_left_ += it->second->undecodable();
      it = readers_.erase(it);
    }
    for (const Cell& cell : join) {
      if (readers_.contains(cell)) continue;
      auto reader = participant_.make_reader(cell_topic(cell));
      if (reader) readers_.emplace(cell, *std::move(reader));  // else tried again next time
    }
    // A writer is discovered some tenths of a second after it is made: make it before the robot
    // crosses into the cell, or its first states there go unheard.
    for (const Cell& cell : speak) writer_of(cell);
    retire_writers();
  }

  std::size_t take(std::vector<CellStatesMessage>& out) override {
    std::size_t taken = 0;
    for (auto& [cell, reader] : readers_) taken += reader->take(out);
    return taken;
  }

  std::uint64_t undecodable() const override {
    std::uint64_t sum = undecodable_of_left_;
    for (const auto& [cell, reader] : readers_) sum += reader->undecodable();
    return sum;
  }

 private:
  struct CellWriter {
    WriterPtr<CellStatesMessage> writer;
    std::uint64_t used = 0;  // value of now_
  };

  void add_cells(const Vec2& position_m, double radius_m, std::set<Cell>& cells) const {
    const auto touching = cells_touching(position_m, radius_m, options_.cell_size_m);
    cells.insert(touching.begin(), touching.end());
  }

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

  std::size_t publish_cell(const Cell& cell, std::span<const RobotStateMessage> states) {
    auto* writer = writer_of(cell);
    if (writer == nullptr) return 0;
    batch_.cell_x = cell.x;
    batch_.cell_y = cell.y;
    std::size_t sent = 0;
    while (!states.empty()) {
      const auto part = states.first(std::min(states.size(), kMaxCellStates));
      batch_.states.assign(part.begin(), part.end());
      if (writer->write(batch_)) sent += part.size();
      states = states.subspan(part.size());
    }
    return sent;
  }

  // Deletes the writers that were not used for longest, never one used since the last
  // listen_around().
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
  std::uint64_t now_ = 0;  // calls of listen_around()
  std::map<Cell, ReaderPtr<CellStatesMessage>> readers_;
  std::map<Cell, CellWriter> writers_;
  CellStatesMessage batch_;  // kept for its memory
  std::uint64_t undecodable_of_left_ = 0;
};

}  // namespace

std::unique_ptr<StateChannel> make_topic_channel(Participant& participant,
                                                 const CellOptions& options) {
  return std::make_unique<TopicChannel>(participant, options);
}

}  // namespace swarm::link
