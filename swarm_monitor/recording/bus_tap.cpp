// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/recording/bus_tap.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/clock.hpp"
#include "swarm_core/robot_log/idl_text.hpp"
#include "swarm_core/robot_log/record_codec.hpp"
#include "swarm_link/channels/groups/group_tap.hpp"
#include "swarm_link/monitor_topics.hpp"
#include "swarm_link/roles/run_meeting.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::monitor {
namespace {

/// Number of cell topics at most (each is a reader to be discovered), and the least depth of a
/// reader's history.
constexpr std::int64_t kMostCells = 400;
constexpr int kLeastDepth = 256;
/// A sample's stamp of sending counts if it is at most this old and not in the future; otherwise
/// the writer's clock is wrong and the time of reception takes its place.
constexpr Duration kMostDelay = std::chrono::seconds(2);

/// Appends the IDL structs that a message type T consists of, innermost first, T itself last: the
/// order in which IDL must declare them.
template <class T>
void add_structs(std::vector<std::string_view>& structs) {
  if constexpr (link::kIsSequence<T>) {
    add_structs<typename T::value_type>(structs);
  } else if constexpr (link::Message<T>) {
    link::for_each_field<T>(
        [&](auto field) { add_structs<typename decltype(field)::Type>(structs); });
    if (std::find(structs.begin(), structs.end(), T::kIdlName) == structs.end()) {
      structs.push_back(T::kIdlName);
    }
  }
}

/// The structs of the message with this type name, found by trying every message of the list.
template <class... M>
std::vector<std::string_view> structs_of(link::MessageList<M...>, const std::string& type) {
  std::vector<std::string_view> structs;
  ((type == link::type_name<M>() ? add_structs<M>(structs) : void()), ...);
  return structs;
}

/// The schema of a recorded topic: its IDL, cut to the structs that it needs, so that a recording
/// can be read without this repository.
mcap::Schema schema_of(const std::string& type) {
  for (const robot_log::Kind& kind : robot_log::kinds()) {
    if (kind.type == type) {
      return {.name = type, .encoding = "omgidl", .data = mcap::blackbox_idl(kind.structs)};
    }
  }
  const auto structs = structs_of(link::AllMessages(), type);
  return {.name = type, .encoding = "omgidl", .data = mcap::wire_idl(structs)};
}

/// Reads all monitor topics, and states from the cells' topics or from the multicast groups.
class RunTap final : public BusTap {
 public:
  explicit RunTap(std::unique_ptr<link::Participant> participant)
      : participant_(std::move(participant)) {}

  Result<void> listen(link::RawTopic topic, std::uint32_t recorded) {
    // Robots want the newest, a recorder all: also what came while it was not looking.
    topic.qos.depth = std::max(topic.qos.depth, kLeastDepth);
    auto reader = participant_->make_reader(topic);
    if (!reader) return tl::unexpected(reader.error());
    readers_.push_back({recorded, std::move(*reader)});
    return {};
  }
  void listen(std::unique_ptr<link::GroupTap> groups) { groups_ = std::move(groups); }

  // Group samples first: only their sockets are waited for.
  void take(Duration timeout, const Sink& sink) override {
    if (groups_) {
      groups_->take_raw(timeout, [&](std::span<const std::byte> bytes) {
        const UtcTime now = utc_now();
        // As DDS would carry it: in multiples of four bytes.
        padded_.assign(bytes.begin(), bytes.end());
        padded_.resize((bytes.size() + 3) / 4 * 4);
        sink({.topic = states_index(), .received = now, .sent = now, .bytes = as_chars(padded_)});
      });
    }
    participant_->receive();
    const UtcTime now = utc_now();
    for (const auto& [topic, reader] : readers_) {
      messages_.clear();
      reader->take(messages_);
      // A reader returns its samples instance by instance; recordings need the order of time.
      std::stable_sort(messages_.begin(), messages_.end(),
                       [](const auto& a, const auto& b) { return a.sent_utc_ns < b.sent_utc_ns; });
      for (const link::RawMessage& message : messages_) {
        const UtcTime sent{Duration(message.sent_utc_ns)};
        const bool plausible = sent <= now && now - sent < kMostDelay;
        sink({.topic = topic,
              .received = now,
              .sent = plausible ? sent : now,
              .bytes = as_chars(message.bytes)});
      }
    }
  }

  bool receives_anything() const override {
    return std::any_of(readers_.begin(), readers_.end(),
                       [](const auto& reader) { return reader.second->matched() > 0; });
  }

 private:
  static std::span<const unsigned char> as_chars(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()};
  }

  std::unique_ptr<link::Participant> participant_;
  std::unique_ptr<link::GroupTap> groups_;  // null: states go by topics
  std::vector<std::pair<std::uint32_t, std::unique_ptr<link::RawReader>>> readers_;
  std::vector<link::RawMessage> messages_;
  std::vector<std::byte> padded_;
};

/// Reads the state topic of every cell of the map and of the ring of cells around it, for robots
/// that leave the bounds.
Result<void> listen_to_cells(RunTap& tap, const Mission& mission) {
  const double size = mission.link.cell_size_m;
  const link::Cell first = link::cell_of(mission.world.bounds_m().min_m - Vec2(size, size), size);
  const link::Cell last = link::cell_of(mission.world.bounds_m().max_m + Vec2(size, size), size);
  const std::int64_t cells =
      (std::int64_t{last.x} - first.x + 1) * (std::int64_t{last.y} - first.y + 1);
  if (cells > kMostCells) {
    return fail(ErrorCode::kBadInput,
                fmt::format("the map has {} cell topics, at most {} can be listened to: make "
                            "link.cell_size_m larger, or fly with --channel groups",
                            cells, kMostCells));
  }
  for (std::int32_t x = first.x; x <= last.x; ++x) {
    for (std::int32_t y = first.y; y <= last.y; ++y) {
      const auto topic = link::cell_topic({x, y});
      link::RawTopic raw = link::states_topic().wire;
      raw.name = topic.name;
      raw.qos = topic.qos;
      if (auto received = tap.listen(raw, states_index()); !received) return received;
    }
  }
  return {};
}

}  // namespace

/// Built once; its order is that of TappedSample::topic.
const std::vector<RecordedTopic>& recorded_topics() {
  static const std::vector<RecordedTopic> kTopics = [] {
    std::vector<RecordedTopic> topics;
    for (const link::MonitorTopic& topic : link::monitor_topics()) {
      topics.push_back({topic.recorded, schema_of(topic.wire.type)});
    }
    topics.push_back({link::states_topic().recorded, schema_of(link::states_topic().wire.type)});
    return topics;
  }();
  return kTopics;
}

std::uint32_t states_index() { return static_cast<std::uint32_t>(recorded_topics().size() - 1); }

/// Joins as a monitor, which agents do not discover: a recorder must not change the load that it
/// measures.
Result<std::unique_ptr<BusTap>> tap_bus(const std::filesystem::path& run_dir,
                                        std::uint32_t number) {
  const auto mission = load_mission(run_dir / shell::kMissionFile, open_catalogue());
  if (!mission) return tl::unexpected(mission.error());
  const auto run = shell::read_run_info(run_dir);
  if (!run) return tl::unexpected(run.error());
  shell::follow(run->clock);
  auto participant = link::join_as_monitor(link::meeting_of(*run), run->agents, number);
  if (!participant) return tl::unexpected(participant.error());
  auto tap = std::make_unique<RunTap>(std::move(*participant));
  std::uint32_t index = 0;
  for (const link::MonitorTopic& topic : link::monitor_topics()) {
    if (auto received = tap->listen(topic.wire, index++); !received) {
      return tl::unexpected(received.error());
    }
  }
  if (auto received = tap->listen(link::states_topic().wire, index); !received) {
    return tl::unexpected(received.error());
  }
  if (run->channel == Channel::kGroups) {
    auto groups = link::make_group_tap(run->domain);
    if (!groups) return tl::unexpected(groups.error());
    tap->listen(std::move(*groups));
  } else if (auto received = listen_to_cells(*tap, *mission); !received) {
    return tl::unexpected(received.error());
  }
  return tap;
}

}  // namespace swarm::monitor
