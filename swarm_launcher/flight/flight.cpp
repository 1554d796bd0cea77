// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/flight.hpp"

#include <cstddef>
#include <cstdio>
#include <iterator>
#include <string_view>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <sys/resource.h>

#include "swarm_core/app/foreign_settings.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_launcher/hosts/last_position.hpp"
#include "swarm_launcher/processes/host_limits.hpp"

namespace swarm::launcher {
namespace {

// Period of the loop, and so the largest delay of a command by the launcher.
constexpr Duration kFlightStep = std::chrono::milliseconds(20);
// Logs of hundreds of robots may have gigabytes.
constexpr Duration kLogsTimeout = std::chrono::minutes(3);

constexpr std::ptrdiff_t kMostNamed = 10;  // files that lack something
constexpr Duration kFilesEvery = std::chrono::seconds(1);
// Thousands of events that wait for the disk.
constexpr std::size_t kEventsBytes = 4U << 20U;

SteadyTime steady_now() { return std::chrono::steady_clock::now(); }

/// Requests that come through the control socket of the run.
class SocketRequests final : public ControlRequests {
 public:
  explicit SocketRequests(shell::ControlServer& server) : server_(server) {}
  std::vector<Request> poll() override { return server_.poll(); }
  void answer(ClientId client, const std::string& text) override { server_.answer(client, text); }

 private:
  shell::ControlServer& server_;
};

RecordedPositions recorded_positions(PreparedRun& run) {
  const auto last_step = [&run](RobotId robot) -> std::optional<LastKnown> {
    if (!run.steps().has(robot)) return run.hosts()->last_known(robot);
    return last_known(run.steps().last(robot), run.options().mission);
  };
  const auto in_log = [&run](RobotId robot) -> std::optional<LastKnown> {
    if (!run.steps().has(robot)) return std::nullopt;
    return last_known_in_log(run.dir(), robot, run.options().mission);
  };
  return {.last_step = last_step, .in_log = in_log};
}

link::StopChannelOptions stop_channel_of(const PreparedRun& run) {
  return {.domain = run.info().domain, .interface = run.options().how.interface};
}

// Without multicast the reliable command topic alone stops the robots.
std::optional<StopOrder> make_stop_order(const PreparedRun& run) {
  auto sender = link::StopSender::open(stop_channel_of(run));
  if (!sender) return std::nullopt;
  return StopOrder(std::move(*sender), run.options().mission.robots.count);
}

std::optional<BeatSender> make_beat_sender(const PreparedRun& run) {
  auto sender = link::StopSender::open(stop_channel_of(run));
  if (!sender) return std::nullopt;
  const auto began = run.info().began.time_since_epoch().count();
  return BeatSender(std::move(*sender), static_cast<std::uint64_t>(began));
}

std::unique_ptr<link::StopReceiver> make_stop_receiver(const PreparedRun& run) {
  auto receiver = link::StopReceiver::open(stop_channel_of(run));
  return receiver ? std::move(*receiver) : nullptr;
}

LineSink to_events_file(PreparedRun& run) {
  auto file = run.files().append_to(files::lines_of(run.dir() / shell::kEventsFile),
                                    shell::Flush::kAtOnce, kEventsBytes);
  return [file](std::string_view line) mutable { file.push(line); };
}

// CPU time of the launcher itself, including the discovery server.
double own_cpu_s() {
  rusage own = {};
  ::getrusage(RUSAGE_SELF, &own);
  return static_cast<double>(own.ru_utime.tv_sec + own.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(own.ru_utime.tv_usec + own.ru_stime.tv_usec);
}

}  // namespace

Flight::Flight(std::unique_ptr<PreparedRun> run, FlightObserver* observer)
    : run_(std::move(run)),
      events_(to_events_file(*run_)),
      log_(events_, *run_->bus().event_relay, progress_),
      requests_(std::make_unique<SocketRequests>(run_->control())),
      helpers_(run_->options().how, run_->dir()),
      stop_(make_stop_order(*run_)),
      stops_(make_stop_receiver(*run_)),
      beats_(make_beat_sender(*run_)) {
  loop_.emplace(run_->options(), run_->dir(),
                FlightPorts{.spawner = spawner_,
                            .bus = run_->bus(),
                            .scene = run_->scene(),
                            .control = *requests_,
                            .helpers = helpers_,
                            .log = log_,
                            .display = progress_,
                            .recorded = recorded_positions(*run_),
                            .inputs = run_->inputs(),
                            .steps = run_->steps().path(),
                            .hosts = run_->hosts(),
                            .observer = observer,
                            .stop = stop_ ? &*stop_ : nullptr,
                            .stops = stops_.get(),
                            .beats = beats_ ? &*beats_ : nullptr},
                steady_now());
}

Result<std::unique_ptr<Flight>> Flight::make(FlightOptions options, FlightObserver* observer) {
  auto run = PreparedRun::make(std::move(options));
  if (!run) return tl::unexpected(run.error());
  auto flight = std::unique_ptr<Flight>(new Flight(std::move(*run), observer));
  flight->report_channel();
  if (const auto started = flight->helpers_.start(steady_now()); !started) {
    return tl::unexpected(started.error());
  }
  flight->report_hosts();
  return flight;
}

/// Reports which channel was chosen and why, and limits of this host that the run may exceed.
void Flight::report_channel() {
  const ChannelChoice& channel = run_->channel();
  const auto report = [this](link::Severity severity, const char* code, const std::string& text) {
    log_.note(utc_now(), severity, code, text);
    std::fprintf(stderr, "%s\n", text.c_str());
  };
  report(link::Severity::kInfo, "channel",
         fmt::format("robot states go by {}: {}", to_string(channel.channel), channel.reason));
  if (const auto notice = shell::dropped_settings_notice()) {
    report(link::Severity::kInfo, "settings-ignored", *notice);
  }
  raise_open_files();
  for (const std::string& shortcoming :
       shortcomings(read_host_limits(), {.agents = run_->info().agents,
                                        .robots_per_process = run_->options().per_process,
                                        .relays = run_->info().relays})) {
    report(link::Severity::kWarning, "host-limits", shortcoming);
  }
}

void Flight::report_hosts() {
  if (run_->hosts() == nullptr) return;
  const FlightChoices& how = run_->options().how;
  std::fprintf(stderr, "%u robots are for other hosts: swarm_launcher join %s:%u\n", how.remote,
               how.interface.c_str(), run_->hosts()->port());
}

// After the last process: the recorder gets every message, and remote logs precede the audit.
Result<Measurements> Flight::fly() {
  for (int interrupts = 0; !loop_->is_done();) {
    for (; interrupts < shell::stop_requests(); ++interrupts) loop_->interrupt();
    const FlightTime now{.steady = steady_now(), .utc = utc_now()};
    if (auto done = loop_->step(now); !done) return tl::unexpected(done.error());
    watch_files(now);
    std::this_thread::sleep_for(kFlightStep);
  }
  helpers_.finish();
  collect_robot_logs();
  Measurements measured = loop_->measurements();
  measured.missing = finish_files();
  progress_.flush();
  measured.cpu_s += own_cpu_s();
  measured.channel = channel();
  return measured;
}

void Flight::watch_files(const FlightTime& now) {
  if (now.steady < next_look_) return;
  next_look_ = now.steady + kFilesEvery;
  if (const auto event = file_watch_.step(run_->files().health(now.steady))) {
    log_.log(now.utc,
             {.warning = event->is_warning, .code = std::string(event->code), .text = event->text});
  }
}

std::vector<std::string> Flight::finish_files() {
  std::vector<std::string> missing = log_.losses();
  for (const shell::FileLoss& loss : run_->files().finish()) {
    missing.push_back("launcher: " + describe(loss));
  }
  if (std::ssize(missing) > kMostNamed) {
    missing.insert(missing.begin() + kMostNamed,
                   fmt::format("{} more", std::ssize(missing) - kMostNamed));
    missing.resize(kMostNamed + 1);
  }
  return missing;
}

/// Waits for the robot logs of other hosts, because the audit covers their robots, too.
void Flight::collect_robot_logs() {
  RemoteHosts* const hosts = run_->hosts();
  if (hosts == nullptr) return;
  for (const SteadyTime until = steady_now() + kLogsTimeout;
       !hosts->collect() && steady_now() < until; std::this_thread::sleep_for(kFlightStep)) {
    progress_.show("ending", fmt::format("{} robot logs under way", hosts->missing_logs()));
  }
  if (hosts->missing_logs() == 0) return;
  log_.log(utc_now(), {.warning = true,
                       .code = "boxes-missing",
                       .text = fmt::format("{} robot logs of other hosts did not come",
                                           hosts->missing_logs())});
}

std::string Flight::planner_complaint() const {
  return shell::read_file(dir() / shell::kLogsFolder / "planner.log", 1U << 20U).value_or("");
}

}  // namespace swarm::launcher
