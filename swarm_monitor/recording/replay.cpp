// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/recording/replay.hpp"

#include <algorithm>
#include <cstdio>
#include <thread>

#include <fmt/format.h>

#include "swarm_core/app/run_dir.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_link/monitor_topics.hpp"
#include "swarm_link/roles/domain_lock.hpp"
#include "swarm_link/roles/run_meeting.hpp"
#include "swarm_monitor/recording/bus_tap.hpp"

namespace swarm::monitor {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(20);
/// Time after the last message in which its receivers can still request it again.
constexpr Duration kLinger = std::chrono::seconds(1);

/// History depth of a replay's writer at most. With ten thousand messages every acknowledgement
/// took 10 ms.
constexpr int kKept = 500;

/// One writer per topic, at the participant of the program that published it: plan and heartbeat
/// from the planner's, all others from the launcher's. So discovery and ownership are those of a
/// run.
class Cast {
 public:
  static Result<Cast> join(const shell::RunInfo& run) {
    auto participants = link::join_as_replay(link::meeting_of(run));
    if (!participants) return tl::unexpected(participants.error());
    Cast cast;
    cast.participants_ = std::move(*participants);
    std::vector<link::MonitorTopic> topics = link::monitor_topics();
    topics.push_back(link::states_topic());
    for (link::MonitorTopic& topic : topics) {
      topic.wire.qos.depth = std::min(topic.wire.qos.depth, kKept);
      const bool planner = topic.recorded == "swarm/plan" || topic.recorded == "swarm/heartbeat";
      auto writer = (planner ? cast.participants_.planner : cast.participants_.launcher)
                        ->make_writer(topic.wire);
      if (!writer) return tl::unexpected(writer.error());
      cast.writers_.push_back(std::move(*writer));
    }
    return cast;
  }

  bool has_readers() const {
    return std::all_of(writers_.begin(), writers_.end(),
                       [](const auto& writer) { return writer->matched() > 0; });
  }

  bool publish(std::uint32_t topic, std::span<const unsigned char> bytes) {
    return writers_[topic]->write(std::as_bytes(bytes));
  }

  void receive() {
    participants_.launcher->receive();
    participants_.planner->receive();
  }

 private:
  link::ReplayParticipants participants_;
  std::vector<std::unique_ptr<link::RawWriter>> writers_;
};

Result<void> write_attachments(const Score& score, const std::filesystem::path& dir) {
  bool has_mission = false;
  for (const mcap::Attachment& attachment : score.attachments) {
    const std::filesystem::path name(attachment.name);
    // The replay has its own run information, and its summary marks the end. Names with folders are
    // skipped: a recording must not write outside the run directory.
    if (name != name.filename() || name == shell::kRunFile || name == shell::kSummaryFile) continue;
    if (auto written = shell::write_file(dir / name, attachment.data); !written) return written;
    has_mission = has_mission || attachment.name == shell::kMissionFile;
  }
  if (has_mission) return {};
  return fail(ErrorCode::kBadInput,
              fmt::format("the recording holds no {}: a replay of it could not be joined",
                          shell::kMissionFile));
}

/// The recorded summary, so that an audit of the replay's directory finds it.
std::string summary_of(const Score& score) {
  for (const mcap::Attachment& attachment : score.attachments) {
    if (attachment.name == shell::kSummaryFile) return attachment.data;
  }
  return "{\"outcome\": \"replayed\"}\n";
}

/// Messages are due at begin + at/rate on the steady clock; while it waits, the loop serves DDS
/// every 20 ms. Returns how many messages DDS refused.
std::uint64_t publish_all(const Score& score, double rate, Cast& cast,
                          const std::function<bool()>& stopped) {
  const auto begin = std::chrono::steady_clock::now();
  std::uint64_t refused = 0;
  for (const ReplayMessage& message : score.messages) {
    const auto at = begin + std::chrono::duration_cast<Duration>(message.at / rate);
    while (!stopped() && std::chrono::steady_clock::now() < at) {
      cast.receive();
      std::this_thread::sleep_until(std::min(at, std::chrono::steady_clock::now() + kStep));
    }
    if (stopped()) break;
    const auto bytes = std::span<const unsigned char>(score.bytes);
    if (!cast.publish(message.topic, bytes.subspan(message.begin, message.size))) ++refused;
  }
  return refused;
}

}  // namespace

/// Makes a run directory like a launcher's, waits for receivers, publishes every message at its
/// time, and writes the summary, by which recorders and views of the replay end.
Result<ExitCode> replay(const ReplayOptions& options) {
  const auto score = read_score(options.file, options.from_s, options.topics);
  if (!score) return tl::unexpected(score.error());
  const link::Meeting star{.relays = 1};
  const auto lock = link::DomainLock::take(
      options.domain,
      {.participants = link::participants_for(star, 0), .fixed = link::fixed_participants(star)});
  if (!lock) return tl::unexpected(lock.error());
  const auto dir = shell::make_run_dir(options.out, "replay");
  if (!dir) return tl::unexpected(dir.error());
  if (auto written = write_attachments(*score, *dir); !written) {
    return tl::unexpected(written.error());
  }
  const shell::RunInfo run{.domain = lock->domain(),
                           .relays = 1,
                           .channel = Channel::kGroups,
                           .began = utc_now(),
                           .is_replay = true};
  auto cast = Cast::join(run);
  if (!cast) return tl::unexpected(cast.error());
  if (auto written = shell::write_run_info(*dir, run); !written) {
    return tl::unexpected(written.error());
  }
  std::fprintf(stderr, "run directory: %s\n%zu messages, %llu of other topics left out\n",
               dir->c_str(), score->messages.size(),
               static_cast<unsigned long long>(score->foreign));

  const auto stopped = [&] { return options.stop_requested && options.stop_requested(); };
  const auto waits_until = std::chrono::steady_clock::now() + from_seconds(options.wait_s);
  while (!cast->has_readers() && std::chrono::steady_clock::now() < waits_until && !stopped()) {
    cast->receive();
    std::this_thread::sleep_for(kStep);
  }
  const std::uint64_t refused = publish_all(*score, options.rate, *cast, stopped);
  const auto ends = std::chrono::steady_clock::now() + kLinger;
  while (std::chrono::steady_clock::now() < ends) {
    cast->receive();
    std::this_thread::sleep_for(kStep);
  }
  if (auto written = shell::write_file(*dir / shell::kSummaryFile, summary_of(*score)); !written) {
    return tl::unexpected(written.error());
  }
  if (refused > 0) {
    return fail(ErrorCode::kEnvironment, fmt::format("DDS refused {} messages", refused));
  }
  if (score->damaged == 0) return ExitCode::kOk;
  std::fprintf(stderr, "%llu damaged places left out\n",
               static_cast<unsigned long long>(score->damaged));
  return ExitCode::kCriteriaNotMet;
}

}  // namespace swarm::monitor
