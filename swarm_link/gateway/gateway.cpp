// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/gateway/gateway.hpp"

#include <algorithm>
#include <map>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "swarm_link/channels/cell_traffic.hpp"
#include "swarm_link/channels/groups/group_channel.hpp"
#include "swarm_link/channels/groups/group_tap.hpp"
#include "swarm_link/gateway/gateway_inbox.hpp"

namespace swarm::link {
namespace {

// Two endpoints per cell: beyond this number their discovery takes too long.
constexpr std::int64_t kMostCells = 256;
constexpr int kOwn = 1;  // our reader and writer of a cell match each other
// Reading the match counts of all endpoints is too costly for every call.
constexpr Duration kLookEvery = std::chrono::milliseconds(200);

struct TopicCell {
  ReaderPtr<CellStatesMessage> reader;
  WriterPtr<CellStatesMessage> writer;
};

// Holds one reader and one writer per topic cell for its whole life, since their discovery takes
// long. Not in use, it closes the tap and sleeps.
class ChannelGateway final : public Gateway {
 public:
  ChannelGateway(Participant& participant, const GatewayOptions& options,
                 std::map<Cell, TopicCell> topics, std::unique_ptr<StateChannel> groups)
      : participant_(participant),
        options_(options),
        topics_(std::move(topics)),
        groups_(std::move(groups)),
        batches_(options.topic_cell_size_m),
        inbox_(options.limits),
        by_topics_at_(options.limits.robots) {}

  void relay(Duration timeout, UtcTime now) override {
    participant_.receive();
    look(now);
    if (!in_use_) {
      tap_.reset();
      std::this_thread::sleep_for(timeout);
      return;
    }
    if (!tap_) {
      auto made = make_group_tap(options_.domain);
      if (made) tap_ = std::move(*made);  // else tried again next time
    }
    received_.clear();
    fresh_.clear();
    if (tap_) {
      tap_->take(timeout, received_);
    } else {
      std::this_thread::sleep_for(timeout);
    }
    // First the states of the groups, then those of the topics, which must go to the groups, too.
    inbox_.take_fresh(received_, now, fresh_);
    const std::size_t from_groups = fresh_.size();
    received_.clear();
    for (auto& [cell, topic] : topics_) topic.reader->take(received_);
    inbox_.take_fresh(received_, now, fresh_);
    for (const RobotStateMessage& state : std::span(fresh_).subspan(from_groups)) {
      by_topics_at_[state.robot_id] = now;  // the inbox has checked the id
    }
    inbox_.set_undecodable(undecodable());
    to_groups_ += groups_->publish(std::span(fresh_).subspan(from_groups));
    for (const CellStatesMessage& batch : batches_.sort(fresh_)) {
      const auto topic = topics_.find({batch.cell_x, batch.cell_y});
      if (topic != topics_.end() && topic->second.writer->write(batch)) {
        to_topics_ += batch.states.size();
      }
    }
  }

  std::uint32_t robots_by_topics(UtcTime now, Duration within) const override {
    return static_cast<std::uint32_t>(std::ranges::count_if(
        by_topics_at_, [&](UtcTime at) { return at != UtcTime{} && now - at <= within; }));
  }
  bool in_use() const override { return in_use_; }
  std::uint64_t to_topics() const override { return to_topics_; }
  std::uint64_t to_groups() const override { return to_groups_; }
  const RefusalCounters& refused() const override { return inbox_.refused(); }

 private:
  // Updates in_use_ from the match counts of the endpoints.
  void look(UtcTime now) {
    if (now - looked_at_ < kLookEvery) return;
    looked_at_ = now;
    in_use_ = std::any_of(topics_.begin(), topics_.end(), [](const auto& topic) {
      return topic.second.reader->matched() > kOwn || topic.second.writer->matched() > kOwn;
    });
  }

  std::uint64_t undecodable() const {
    std::uint64_t undecodable = 0;
    for (const auto& [cell, topic] : topics_) undecodable += topic.reader->undecodable();
    return undecodable;
  }

  Participant& participant_;
  GatewayOptions options_;
  std::map<Cell, TopicCell> topics_;
  std::unique_ptr<StateChannel> groups_;
  std::unique_ptr<GroupTap> tap_;
  CellBatches batches_;
  GatewayInbox inbox_;
  std::vector<UtcTime> by_topics_at_;  // by robot: the last state that arrived by topics
  std::vector<CellStatesMessage> received_;
  std::vector<RobotStateMessage> fresh_;
  UtcTime looked_at_{};
  bool in_use_ = false;
  std::uint64_t to_topics_ = 0;
  std::uint64_t to_groups_ = 0;
};

}  // namespace

Result<std::unique_ptr<Gateway>> make_gateway(Participant& participant,
                                              const GatewayOptions& options) {
  const Cell first = cell_of(options.limits.bounds_m.min_m, options.topic_cell_size_m);
  const Cell last = cell_of(options.limits.bounds_m.max_m, options.topic_cell_size_m);
  const std::int64_t cells =
      (std::int64_t{last.x} - first.x + 1) * (std::int64_t{last.y} - first.y + 1);
  if (cells > kMostCells) {
    return fail(ErrorCode::kBadInput,
                fmt::format("a gateway would need {} cell topics, at most {} are good: make "
                            "link.cell_size_m larger",
                            cells, kMostCells));
  }
  std::map<Cell, TopicCell> topics;
  for (std::int32_t x = first.x; x <= last.x; ++x) {
    for (std::int32_t y = first.y; y <= last.y; ++y) {
      auto reader = participant.make_reader(cell_topic({x, y}));
      if (!reader) return tl::unexpected(reader.error());
      auto writer = participant.make_writer(cell_topic({x, y}));
      if (!writer) return tl::unexpected(writer.error());
      topics.emplace(Cell{x, y}, TopicCell{std::move(*reader), std::move(*writer)});
    }
  }
  GroupChannelOptions groups{.domain = options.domain, .interface = options.interface};
  groups.cells.cell_size_m = options.group_cell_size_m;
  auto channel = make_group_channel(groups);
  if (!channel) return tl::unexpected(channel.error());
  return std::make_unique<ChannelGateway>(participant, options, std::move(topics),
                                          std::move(*channel));
}

}  // namespace swarm::link
