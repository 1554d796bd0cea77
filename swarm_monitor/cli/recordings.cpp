// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <iterator>
#include <memory>
#include <set>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "swarm_core/app/output.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_monitor/cli/commands.hpp"
#include "swarm_monitor/recording/live_recorder.hpp"
#include "swarm_monitor/recording/merge.hpp"
#include "swarm_monitor/recording/message_json.hpp"
#include "swarm_monitor/recording/replay.hpp"

namespace swarm::monitor::cli {
namespace {

bool stop_requested() { return shell::stop_requests() > 0; }

/// A warning with the topics of the recording. Topics of cells are many: the list is cut.
std::string no_topic_matches(const std::set<std::string>& topics) {
  constexpr std::size_t kMostNamed = 20;
  if (topics.empty()) return "the recording holds no message\n";
  const auto last =
      std::next(topics.begin(), static_cast<std::ptrdiff_t>(std::min(kMostNamed, topics.size())));
  std::string text = fmt::format("no topic matches; the recording holds {}",
                                 fmt::join(topics.begin(), last, ", "));
  if (topics.size() > kMostNamed) text += fmt::format(" and {} more", topics.size() - kMostNamed);
  return text + "\n";
}

}  // namespace

Command add_record(CLI::App& program) {
  const auto o = std::make_shared<RecordOptions>();
  o->stop_requested = stop_requested;
  CLI::App* const record = program.add_subcommand(
      "record", "Record the bus of a run in progress, each message as it is sent");
  record->add_option("run_dir", o->run_dir, "Run directory of a run in progress")
      ->required()
      ->check(CLI::ExistingDirectory)
      ->type_name("RUN_DIR");
  record->add_option("--out", o->out, "Recording (default: bus.mcap in the run directory)")
      ->type_name("FILE");
  record->add_option("--duration-s", o->duration_s, "End after this long (default: with the run)")
      ->check(CLI::PositiveNumber);
  return {record, [o]() -> Result<ExitCode> {
            shell::catch_stop_signals(shell::Hangup::kStop);
            if (auto joinable = check_in_progress(o->run_dir); !joinable) {
              return tl::unexpected(joinable.error());
            }
            const auto result = record_bus(*o);
            if (!result) return tl::unexpected(result.error());
            std::fputs(to_json(*result).c_str(), stdout);
            return ExitCode::kOk;
          }};
}

Command add_merge(CLI::App& program) {
  struct Options {
    std::filesystem::path run_dir, out;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* const merge = program.add_subcommand(
      "merge", "Make one recording of all robot logs, recordings and files of a run");
  merge->add_option("run_dir", o->run_dir, "Run directory")
      ->required()
      ->check(CLI::ExistingDirectory)
      ->type_name("RUN_DIR");
  merge->add_option("--out", o->out, "Recording (default: recording.mcap in the run directory)")
      ->type_name("FILE");
  // Progress goes to stderr and only to a terminal, so that the JSON on stdout and log files stay
  // clean.
  return {merge, [o]() -> Result<ExitCode> {
            const bool live = ::isatty(STDERR_FILENO) != 0;
            const auto result = merge_run(o->run_dir, o->out, [live](double share) {
              if (live) std::fprintf(stderr, "\rmerging: %3.0f %%", 100.0 * share);
            });
            if (live) std::fputs("\r\x1b[K", stderr);
            if (!result) return tl::unexpected(result.error());
            std::fputs(to_json(*result).c_str(), stdout);
            return ExitCode::kOk;
          }};
}

Command add_cat(CLI::App& program) {
  struct Options {
    std::filesystem::path file;
    std::vector<std::string> topics;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* const cat =
      program.add_subcommand("cat", "Print a recording's messages as lines of JSON");
  cat->add_option("file", o->file, "Recording")
      ->required()
      ->check(CLI::ExistingFile)
      ->type_name("FILE");
  cat->add_option("--topics", o->topics,
                  "Only topics with these prefixes, like swarm/,blackbox/step")
      ->delimiter(',');
  // Damage is reported on stderr at the end: the readable messages were printed by then.
  return {cat, [o]() -> Result<ExitCode> {
            const auto done = print_messages(o->file, o->topics, [](const std::string& line) {
              std::fputs(line.c_str(), stdout);
              std::fputc('\n', stdout);
              return shell::output_works();
            });
            if (!done) return tl::unexpected(done.error());
            if (!shell::output_works()) return ExitCode::kOk;  // run_main() reports it
            if (done->damage.damaged > 0) {
              std::fprintf(stderr, "%llu damaged places left out\n",
                           static_cast<unsigned long long>(done->damage.damaged));
            }
            if (done->damage.truncated) std::fputs("the file ends inside a record\n", stderr);
            if (done->printed == 0 && !o->topics.empty()) {
              std::fputs(no_topic_matches(done->topics).c_str(), stderr);
            }
            return done->damage.damaged > 0 ? ExitCode::kCriteriaNotMet : ExitCode::kOk;
          }};
}

Command add_replay(CLI::App& program) {
  const auto o = std::make_shared<ReplayOptions>();
  o->stop_requested = stop_requested;
  CLI::App* const replay_command = program.add_subcommand(
      "replay", "Publish a recording again on a bus of its own; record, view and top can join it");
  replay_command->add_option("file", o->file, "Recording")
      ->required()
      ->check(CLI::ExistingFile)
      ->type_name("FILE");
  replay_command
      ->add_option("--rate", o->rate, "Speed: 2 is twice as fast as recorded (default: 1)")
      ->check(CLI::Range(0.01, 1000.0));
  replay_command->add_option("--from", o->from_s, "Begin this many seconds after the first message")
      ->check(CLI::Range(0.0, 1e9));
  replay_command
      ->add_option("--topics", o->topics,
                   "Only topics with these prefixes, like swarm/,blackbox/step")
      ->delimiter(',');
  replay_command->add_option("--wait-s", o->wait_s, "Wait this long for a receiver (default: 5)")
      ->check(CLI::Range(0.0, 1e6));
  replay_command->add_option("--domain", o->domain, "DDS domain (default: a free one)")
      ->check(CLI::Range(0, 229));
  replay_command->add_option("--out", o->out, "Run directory (default: runs/replay-<time>)");
  return {replay_command, [o]() -> Result<ExitCode> {
            shell::catch_stop_signals(shell::Hangup::kStop);
            return replay(*o);
          }};
}

}  // namespace swarm::monitor::cli
