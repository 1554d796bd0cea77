// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/recording/live_recorder.hpp"

#include <nlohmann/json.hpp>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_core/robot_log/writer.hpp"
#include "swarm_link/cdr/codec.hpp"
#include "swarm_monitor/recording/bus_tap.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::monitor {
namespace {

/// Wait for states per step, and the period in which chunks are written to the disk.
constexpr Duration kTimeout = std::chrono::milliseconds(5);
constexpr Duration kFlushEvery = std::chrono::seconds(1);
/// A run whose launcher was killed writes no summary: its recording ends after this silence.
constexpr Duration kSilence = std::chrono::seconds(20);
constexpr std::size_t kMaxMissionBytes = 16U << 20U;

std::int64_t ns(UtcTime time) { return time.time_since_epoch().count(); }

}  // namespace

/// The loop takes samples as they are and decodes states only to count losses. It ends at a stop
/// signal, after the duration, with the run's summary, or after a long silence.
Result<RecordResult> record_bus(const RecordOptions& options) {
  const auto mission_yaml =
      shell::read_file(options.run_dir / shell::kMissionFile, kMaxMissionBytes);
  if (!mission_yaml) return tl::unexpected(mission_yaml.error());
  const auto mission =
      parse_mission(*mission_yaml, std::string(shell::kMissionFile), {}, open_catalogue());
  if (!mission) return tl::unexpected(mission.error());
  auto tap = tap_bus(options.run_dir);
  if (!tap) return tl::unexpected(tap.error());
  RecordResult result{.file = options.out.empty() ? options.run_dir / "bus.mcap" : options.out,
                      .by_topic = std::vector<std::uint64_t>(recorded_topics().size())};
  auto writer = mcap::Writer::create(result.file);
  if (!writer) return tl::unexpected(writer.error());
  writer->add(mcap::Attachment{.log_time_ns = ns(utc_now()),
                               .name = std::string(shell::kMissionFile),
                               .media_type = "application/yaml",
                               .data = *mission_yaml});
  for (const RecordedTopic& topic : recorded_topics()) {
    writer->add_channel(topic.name, topic.schema);
  }

  link::StreamMeter meter(mission->robots.count);
  link::CellStatesMessage states;
  const UtcTime began = utc_now();
  UtcTime received_at = began, flushed_at = began;
  for (;;) {
    (*tap)->take(kTimeout, [&](const TappedSample& sample) {
      writer->write(static_cast<std::uint16_t>(sample.topic), ns(sample.received), ns(sample.sent),
                    sample.bytes);
      ++result.by_topic[sample.topic];
      received_at = sample.received;
      if (sample.topic != states_index()) return;
      // Only to count what is missing; the file holds the bytes.
      if (!link::decode(std::as_bytes(sample.bytes), states)) return;
      for (const auto& state : states.states) meter.receive(state, sample.received);
    });
    const UtcTime now = utc_now();
    if (options.stop_requested && options.stop_requested()) break;
    if (options.duration_s && to_seconds(now - began) >= *options.duration_s) break;
    if (now - received_at > kSilence) break;
    if (now - flushed_at < kFlushEvery) continue;
    flushed_at = now;
    writer->flush();
    if (std::error_code e; std::filesystem::exists(options.run_dir / shell::kSummaryFile, e)) break;
  }
  const auto finished = writer->finish();
  result.messages = writer->messages();
  result.dropped = writer->dropped();
  result.states = meter.counts();
  if (!finished) return tl::unexpected(finished.error());
  return result;
}

std::string to_json(const RecordResult& result) {
  nlohmann::json topics = nlohmann::json::object();  // also if nothing was received
  for (std::size_t i = 0; i < result.by_topic.size(); ++i) {
    if (result.by_topic[i] > 0) topics[recorded_topics()[i].name] = result.by_topic[i];
  }
  return nlohmann::json{{"file", result.file.string()},
                        {"messages", result.messages},
                        {"dropped_by_disk", result.dropped},
                        {"states",
                         {{"received", result.states.received},
                          {"lost", result.states.lost},
                          {"duplicates", result.states.duplicates}}},
                        {"topics", topics}}
             .dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
         "\n";
}

}  // namespace swarm::monitor
