// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "swarm_core/robot_log/format.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::monitor {

/// A message of a recording, to be published `at` after the begin of the replay.
struct ReplayMessage {
  Duration at{};
  std::uint32_t topic = 0;  ///< as recorded_topics()
  std::uint32_t size = 0;
  std::size_t begin = 0;  ///< in Score::bytes
};

/// The messages of a replay and their times: each topic in the order of the file, at the times when
/// its writer sent it. Where a writer's clock steps back, the later messages get the latest time so
/// far.
struct Score {
  std::vector<ReplayMessage> messages{};  ///< in the order of `at`
  mcap::Bytes bytes{};
  std::vector<mcap::Attachment> attachments{};
  std::uint64_t foreign = 0;  ///< messages of unknown or unwanted topics, left out
  std::uint64_t damaged = 0;
};

/// `topics` are prefixes; empty: all. Messages before `from_s` are left out, except for the last
/// one of each latched topic (plan, scene, command), which comes first.
Result<Score> read_score(const std::filesystem::path& file, double from_s,
                         const std::vector<std::string>& topics);

struct ReplayOptions {
  std::filesystem::path file;
  std::filesystem::path out{};  ///< run directory of the replay; empty: runs/replay-<time>
  double rate = 1.0;
  double from_s = 0.0;
  std::vector<std::string> topics{};
  int domain = -1;      ///< negative: a free one
  double wait_s = 5.0;  ///< for receivers of all topics
  std::function<bool()> stop_requested{};
};

/// Publishes a recording on a bus of its own, as launcher and planner did, with a run directory by
/// which others join as they join a run: record, view, or an agent. The time of sending is that of
/// the replay; stamps inside messages stay as they were. kCriteriaNotMet if places of the file were
/// damaged, whose messages are left out.
Result<ExitCode> replay(const ReplayOptions& options);

}  // namespace swarm::monitor
