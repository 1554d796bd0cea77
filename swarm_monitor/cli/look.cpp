// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "swarm_core/app/output.hpp"
#include "swarm_core/app/run_dir.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_monitor/cli/commands.hpp"
#include "swarm_monitor/view/live_source.hpp"
#include "swarm_monitor/view/recorded_source.hpp"
#include "swarm_monitor/view/remote_control.hpp"
#include "swarm_monitor/view/top_text.hpp"
#include "swarm_monitor/view/view_server.hpp"

namespace swarm::monitor::cli {
namespace {

/// Longest wait per step of view and top; it also bounds the delay of Ctrl-C.
constexpr Duration kTimeout = std::chrono::milliseconds(10);
/// Numbers of the monitors of a run: recorder 0, view 1, top 2. Each number has a participant port
/// of its own, so that all three can join the same run.
constexpr std::uint32_t kViewNumber = 1;
constexpr std::uint32_t kTopNumber = 2;

struct ViewOptions {
  std::filesystem::path from;
  ViewServerOptions server{};
};

/// Serves until a stop signal. The address is printed first, with the token in the fragment, which
/// browsers do not send to servers.
Result<ExitCode> serve(ViewServerOptions options, ViewSource& source) {
  const auto server = ViewServer::make(options, source);
  if (!server) return tl::unexpected(server.error());
  std::printf("http://%s:%u/%s%s\n", options.address.c_str(), (*server)->port(),
              options.token.empty() ? "" : "#token=", options.token.c_str());
  std::fflush(stdout);
  while (shell::stop_requests() == 0) (*server)->serve(kTimeout);
  return ExitCode::kOk;
}

/// A run directory without the summary with which a launcher ends.
bool has_no_summary(const std::filesystem::path& run_dir) {
  std::error_code error;
  return std::filesystem::is_directory(run_dir, error) &&
         !std::filesystem::exists(run_dir / shell::kSummaryFile, error);
}

/// A run in progress is joined on the bus, a finished run or a recording is read as a whole.
Result<ExitCode> view(ViewOptions options) {
  if (!is_in_progress(options.from)) {
    if (options.server.allow_control) {
      return fail(ErrorCode::kBadInput, "--allow-control: this run has ended");
    }
    if (has_no_summary(options.from)) {
      std::fprintf(stderr,
                   "this run has ended without a summary, its launcher does not run any "
                   "more: its recording is shown\n");
    }
    auto run = read_run(options.from);
    if (!run) return tl::unexpected(run.error());
    RecordedSource source(std::move(*run));
    shell::catch_stop_signals(shell::Hangup::kStop);
    return serve(options.server, source);
  }
  shell::catch_stop_signals(shell::Hangup::kStop);
  auto source = look_at_run(options.from, kViewNumber, options.server.allow_control);
  if (!source) return tl::unexpected(source.error());
  std::optional<RemoteControl> control;
  if (options.server.allow_control) {
    control.emplace(options.from, **source);
    options.server.token = make_token();
    options.server.control = [&](const ControlRequest& request) { return control->ask(request); };
  }
  return serve(options.server, **source);
}

/// Joins the run as a monitor and redraws the terminal once a second, between polls of 10 ms; ends
/// with the run.
Result<ExitCode> top(const std::filesystem::path& run_dir) {
  if (auto joinable = check_in_progress(run_dir); !joinable) {
    return tl::unexpected(joinable.error());
  }
  shell::catch_stop_signals(shell::Hangup::kStop);
  auto source = look_at_run(run_dir, kTopNumber);
  if (!source) return tl::unexpected(source.error());
  const bool live = ::isatty(STDOUT_FILENO) != 0;
  TopFacts facts{.name = (*source)->mission().name};
  std::uint64_t received = 0;
  UtcTime shown = utc_now();
  while (shell::stop_requests() == 0) {
    std::this_thread::sleep_for(kTimeout);
    const UtcTime now = utc_now();
    (*source)->poll(now);
    if (now - shown < std::chrono::seconds(1)) continue;
    const std::uint64_t all = (*source)->state().meter().counts().received;
    facts.states_hz = static_cast<double>(all - received) / to_seconds(now - shown);
    facts.latency = (*source)->state().meter().latency();
    winsize window{};
    if (live && ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_row > 0) {
      facts.rows = static_cast<std::size_t>(std::max(3, window.ws_row - 11));  // 11: other lines
    }
    received = all;
    shown = now;
    std::fputs(live ? "\x1b[H\x1b[J" : "", stdout);
    std::fputs(top_text((*source)->state(), facts, now).c_str(), stdout);
    std::fflush(stdout);
    if (!shell::output_works()) break;
    if (!is_in_progress(run_dir)) break;
  }
  return ExitCode::kOk;
}

}  // namespace

// A launcher that was killed leaves no summary, so that alone does not show that the run goes on.
bool is_in_progress(const std::filesystem::path& run_dir) {
  return has_no_summary(run_dir) && shell::is_run_alive(run_dir);
}

// Joining a finished run would succeed, and wait for robots that never come.
Result<void> check_in_progress(const std::filesystem::path& run_dir) {
  if (is_in_progress(run_dir)) return {};
  return fail(ErrorCode::kEnvironment,
              fmt::format("{}: this run is not in progress; see view, report and audit for a "
                          "finished one",
                          run_dir.string()));
}

Command add_view(CLI::App& program) {
  const auto o = std::make_shared<ViewOptions>();
  CLI::App* const command = program.add_subcommand(
      "view", "Show a run or a recording in the browser and in Foxglove; metrics for Prometheus");
  command->add_option("run", o->from, "Run directory, or a recording")
      ->required()
      ->check(CLI::ExistingPath)
      ->type_name("RUN_DIR|FILE");
  command->add_option("--address", o->server.address, "Address to listen at")
      ->check(CLI::ValidIPV4)
      ->capture_default_str();
  command->add_option("--port", o->server.port, "Port to listen at (default: a free one)");
  command->add_option(
      "--host-name", o->server.host_names,
      "Additional host name accepted in the URL; this machine's names are accepted anyway");
  command->add_flag("--allow-control", o->server.allow_control,
                    "Let anyone with the printed address pause, stop and change the mission");
  return {command, [o] { return view(*o); }};
}

Command add_top(CLI::App& program) {
  const auto run_dir = std::make_shared<std::filesystem::path>();
  CLI::App* const command =
      program.add_subcommand("top", "Show a run in progress in the terminal, once a second");
  command->add_option("run_dir", *run_dir, "Run directory of a run in progress")
      ->required()
      ->check(CLI::ExistingDirectory)
      ->type_name("RUN_DIR");
  return {command, [run_dir] { return top(*run_dir); }};
}

}  // namespace swarm::monitor::cli
