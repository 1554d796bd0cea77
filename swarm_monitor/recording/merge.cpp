// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/recording/merge.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/robot_log/reader.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarm_core/robot_log/writer.hpp"

namespace swarm::monitor {
namespace {

/// Limit of an attached text file.
constexpr std::size_t kMaxTextBytes = 256U << 20U;

/// All messages of several files in memory, sorted by time when they are written.
class Pile {
 public:
  /// `lost` counts for robot logs, whose records are numbered.
  Result<robot_log::Damage> add(const std::filesystem::path& file) {
    robot_log::LostRecords lost;
    const auto read =
        mcap::read(file, {.message = [&](const mcap::Message& message, const mcap::Channel& channel,
                                         const mcap::Schema& schema) {
                     lost.add(message.sequence);
                     entries_.push_back({.log_time_ns = message.log_time_ns,
                                         .publish_time_ns = message.publish_time_ns,
                                         .begin = bytes_.size(),
                                         .size = static_cast<std::uint32_t>(message.data.size()),
                                         .channel = number_of(channel, schema)});
                     bytes_.insert(bytes_.end(), message.data.begin(), message.data.end());
                   }});
    if (!read) return tl::unexpected(read.error());
    return robot_log::Damage{*read, lost.count()};
  }

  void write(mcap::Writer& writer, const std::function<void(double)>& progress) {
    // The stable sort keeps the order of files, and of messages within a file, at equal stamps.
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const Entry& a, const Entry& b) { return a.log_time_ns < b.log_time_ns; });
    std::vector<std::uint16_t> numbers;
    for (const auto& [channel, schema] : channels_) {
      numbers.push_back(writer.add_channel(channel.topic, schema, channel.metadata));
    }
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const Entry& entry = entries_[i];
      writer.write(numbers[entry.channel], entry.log_time_ns, entry.publish_time_ns,
                   std::span<const unsigned char>(bytes_).subspan(entry.begin, entry.size));
      if (progress && i % 100'000 == 0) {
        progress(static_cast<double>(i) / static_cast<double>(entries_.size()));
      }
    }
  }

  // Earliest log time of all messages; 0 without any.
  std::int64_t begin_ns() const {
    std::int64_t begin = 0;
    for (const Entry& entry : entries_) {
      begin = &entry == &entries_.front() ? entry.log_time_ns : std::min(begin, entry.log_time_ns);
    }
    return begin;
  }

 private:
  struct Entry {
    std::int64_t log_time_ns = 0, publish_time_ns = 0;
    std::size_t begin = 0;
    std::uint32_t size = 0;
    std::uint32_t channel = 0;
  };

  // The number of a channel in the output: the same topic and type in several files is one channel.
  std::uint32_t number_of(const mcap::Channel& channel, const mcap::Schema& schema) {
    const auto [it, added] = numbers_.try_emplace({channel.topic, schema.name},
                                                  static_cast<std::uint32_t>(channels_.size()));
    if (added) channels_.emplace_back(channel, schema);
    return it->second;
  }

  mcap::Bytes bytes_;
  std::vector<Entry> entries_;
  std::map<std::pair<std::string, std::string>, std::uint32_t> numbers_;
  std::vector<std::pair<mcap::Channel, mcap::Schema>> channels_;
};

/// The wanted files of a folder by name, so that the result does not depend on the file system's
/// order.
std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder,
                                            const std::function<bool(const std::string&)>& wanted) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.is_regular_file(error) && wanted(entry.path().filename().string())) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Files of a run that the audit needs beside the robot logs: with them a recording alone can be
/// audited.
bool is_attached(const std::string& name) {
  return name == shell::kMissionFile || name == shell::kSceneFile || name == shell::kEventsFile ||
         name == shell::kSummaryFile || name == shell::kRunFile || name == shell::kPlanStatsFile ||
         name == shell::kPlanClockFile || (name.starts_with("plan") && name.ends_with(".json"));
}

std::string media_type_of(const std::string& name) {
  return name.ends_with(".yaml") ? "application/yaml"
         : name.ends_with("l")   ? "application/jsonl"
                                 : "application/json";
}

}  // namespace

/// A file that cannot be read counts as damaged and does not stop the merge: after a crash most of
/// the logs are intact.
Result<MergeResult> merge_run(const std::filesystem::path& run_dir,
                              const std::filesystem::path& out,
                              const std::function<void(double)>& progress) {
  const auto boxes = files_in(run_dir / shell::kRobotLogFolder, [](const std::string& name) {
    return name.starts_with("robot-") && name.ends_with(".mcap");
  });
  const auto recordings = files_in(run_dir, [](const std::string& name) {
    return name.starts_with("bus") && name.ends_with(".mcap");
  });
  if (boxes.empty() && recordings.empty()) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("{} holds no robot log and no recording: is it a run directory?",
                            run_dir.string()));
  }
  MergeResult result{.file = out.empty() ? run_dir / "recording.mcap" : out};
  Pile pile;
  const auto take = [&](const std::filesystem::path& file, std::uint32_t& count) -> std::uint64_t {
    const auto damage = pile.add(file);
    if (!damage) {
      ++result.damaged;  // not a recording at all
      return 0;
    }
    ++count;
    result.damaged += damage->damaged;
    result.unended += damage->ended ? 0 : 1;
    return damage->lost;
  };
  for (const auto& box : boxes) result.lost += take(box, result.boxes);
  for (const auto& recording : recordings) take(recording, result.recordings);

  auto writer = mcap::Writer::create(result.file);
  if (!writer) return tl::unexpected(writer.error());
  const std::int64_t begin_ns = pile.begin_ns();
  writer->add(mcap::Metadata{
      .name = std::string(robot_log::kMergeMetadata),
      .values = {{"version", SWARM_VERSION},
                 {"boxes", fmt::format("{}", result.boxes)},
                 {"unended", fmt::format("{}", result.unended)},
                 {"damaged", fmt::format("{}", result.damaged)},
                 {std::string(robot_log::kMergeLost), fmt::format("{}", result.lost)}}});
  for (const auto& file : files_in(run_dir, is_attached)) {
    const auto text = shell::read_file(file, kMaxTextBytes);
    if (!text) continue;
    const std::string name = file.filename().string();
    writer->add(mcap::Attachment{
        .log_time_ns = begin_ns, .name = name, .media_type = media_type_of(name), .data = *text});
  }
  pile.write(*writer, progress);
  const auto finished = writer->finish();
  result.messages = writer->messages();
  if (!finished) return tl::unexpected(finished.error());
  return result;
}

std::string to_json(const MergeResult& result) {
  return nlohmann::json{{"file", result.file.string()}, {"messages", result.messages},
                        {"boxes", result.boxes},        {"recordings", result.recordings},
                        {"unended", result.unended},    {"damaged", result.damaged},
                        {"lost", result.lost}}
             .dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
         "\n";
}

}  // namespace swarm::monitor
