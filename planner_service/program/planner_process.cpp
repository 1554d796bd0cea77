// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/program/planner_process.hpp"

#include <algorithm>
#include <ctime>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "planner_service/keeper/plan_keeper.hpp"
#include "planner_service/keeper/rival_watch.hpp"
#include "planner_service/program/heartbeat_thread.hpp"
#include "planner_service/program/kept_plans.hpp"
#include "planner_service/program/planner_inbox.hpp"
#include "swarm_core/app/file_thread.hpp"
#include "swarm_core/app/file_watch.hpp"
#include "swarm_core/app/run_inputs.hpp"
#include "swarm_core/app/run_membership.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_core/plan/plan_json.hpp"
#include "swarm_core/plan/planning_record.hpp"
#include "swarm_link/roles/run_meeting.hpp"
#include "swarm_link/to_message.hpp"
#include "swarm_link/topics.hpp"

namespace swarm::planner {
namespace {

// A change of the scene must lead to a published plan within 100 ms; polling may take only a small
// part of that.
constexpr Duration kStep = std::chrono::milliseconds(5);
// A plan takes as long as the mission waits for the first one, or this time if that is longer. The
// planner hangs if it takes longer.
constexpr double kLongestPlan_s = 30.0;
constexpr std::uint64_t kFaultSeed = 0xFA17;  // own random numbers for the link
constexpr Duration kFilesEvery = std::chrono::seconds(1);
// Until what a process sends last has been received; its writers end with it.
constexpr Duration kLinger = std::chrono::milliseconds(300);
constexpr std::size_t kClockBytes = 256U << 10U;  // many minutes of a disk that takes nothing

// std::this_thread::sleep_for would sleep on after a signal.
void sleep_for(Duration d) {
  const timespec t{.tv_sec = 0, .tv_nsec = static_cast<long>(d.count())};
  ::nanosleep(&t, nullptr);  // a stop signal wakes it
}

std::string to_json(const PlanStats& stats) {
  const nlohmann::ordered_json json = {{"nodes", stats.nodes},
                                       {"edges", stats.edges},
                                       {"roadmap_ms", stats.roadmap_ms},
                                       {"search_ms", stats.search_ms},
                                       {"transport_ms", stats.transport_ms},
                                       {"smoothing_ms", stats.smoothing_ms},
                                       {"total_ms", stats.total_ms},
                                       {"planned_mean_path_m", stats.planned_mean_path_m}};
  return json.dump(2) + "\n";
}

}  // namespace

struct PlannerProcess::Impl {
  ProcessOptions options;
  const PlanningRegistry* registry = nullptr;
  std::uint64_t seed = 0;
  Mission mission;
  std::optional<PlanKeeper> keeper;
  PlannerEpoch epoch;
  std::unique_ptr<link::Participant> participant;
  link::WriterPtr<link::PlanMessage> plan_writer;
  link::WriterPtr<link::EventMessage> event_writer;
  std::optional<PlannerInbox> inbox;
  std::optional<RivalWatch> rivals;
  std::optional<HeartbeatThread> heartbeats;  // after the participant: it ends first
  shell::FileThread files;
  std::optional<shell::AppendStream> clock_file;
  shell::FileWatch file_watch;
  SteadyTime next_look{};
  link::RefusalCounters reported;  // counts already announced as events

  Result<void> make_keeper();
  Result<void> make_plan_writer();
  Result<void> plan_first();
  Result<void> join(const shell::RunInfo& run);
  void receive(SteadyTime now);
  void watch_rivals(SteadyTime now);
  void take_over(SteadyTime now);
  void keep_planned(SteadyTime now);
  void publish();
  void announce(link::Severity severity, const std::string& code, const std::string& text);
  void report_refusals();
  void watch_files(SteadyTime now);
  void finish_files();
};

// The epoch is the time of this call, so that the plans supersede those before.
Result<void> PlannerProcess::Impl::make_keeper() {
  auto planner = Planner::make(*registry, mission);
  if (!planner) return tl::unexpected(planner.error());
  keeper.emplace(mission, *std::move(planner), seed, &std::chrono::steady_clock::now);
  epoch = PlannerEpoch(static_cast<std::uint64_t>(utc_now().time_since_epoch().count()));
  return {};
}

// Queues plan and statistics for the run directory.
Result<void> PlannerProcess::Impl::plan_first() {
  const PlanningRecord promised{mission.planner.method,
                                keeper->method().traits().density_cap_per_m2};
  files.keep(options.run_dir / shell::kPlanningFile, to_json(promised));
  if (auto planned = keeper->plan_first(); !planned) return planned;
  const PlanResult& planned = keeper->newest().planned;
  files.keep(options.run_dir / shell::kPlanFile, to_json(planned.plan));
  files.keep(options.run_dir / shell::kPlanStatsFile, to_json(planned.stats));
  return {};
}

Result<void> PlannerProcess::Impl::make_plan_writer() {
  auto plans = participant->make_writer(link::plan_topic());
  if (!plans) return tl::unexpected(plans.error());
  plan_writer = std::move(*plans);
  return {};
}

// Creates all writers and readers first and takes them over only when none failed.
Result<void> PlannerProcess::Impl::join(const shell::RunInfo& run) {
  auto made = link::join_as_planner(link::meeting_of(
      run,
      {.faults = options.faults, .seed = mix_seed(run.seed, kFaultSeed), .run_began = run.began}));
  if (!made) return tl::unexpected(made.error());
  participant = std::move(*made);
  if (auto made_plans = make_plan_writer(); !made_plans) return made_plans;
  auto beats = participant->make_writer(link::heartbeat_topic());
  auto events = participant->make_writer(link::event_topic());
  auto orders = participant->make_reader(link::command_topic());
  auto scene_changes = participant->make_reader(link::scene_topic());
  auto health = participant->make_reader(link::status_topic_unacknowledged());
  auto planners = participant->make_reader(link::heartbeat_topic());
  if (!beats) return tl::unexpected(beats.error());
  if (!events) return tl::unexpected(events.error());
  if (!orders) return tl::unexpected(orders.error());
  if (!scene_changes) return tl::unexpected(scene_changes.error());
  if (!health) return tl::unexpected(health.error());
  if (!planners) return tl::unexpected(planners.error());
  event_writer = std::move(*events);
  const link::WireLimits limits = link::wire_limits(mission);
  inbox.emplace(Readers{std::move(*orders), std::move(*scene_changes), std::move(*health),
                        std::move(*planners)},
                limits);
  rivals.emplace(epoch.value(), limits.planner_takeover, std::chrono::steady_clock::now());
  clock_file.emplace(files.append_to(files::lines_of(options.run_dir / shell::kPlanClockFile),
                                     shell::Flush::kAtOnce, kClockBytes));
  keeper->begin(std::chrono::steady_clock::now());
  const double longest_step_s = std::max(kLongestPlan_s, mission.launcher.quorum_timeout_s);
  heartbeats.emplace(std::move(*beats), HeartbeatSource(epoch, from_seconds(longest_step_s)),
                     from_seconds(1.0 / mission.timing.heartbeat_hz));
  return {};
}

void PlannerProcess::Impl::receive(SteadyTime now) {
  participant->receive();
  inbox->receive(utc_now());
  keeper->set_phase(inbox->phase());
  for (Scene& scene : inbox->scenes()) keeper->take_scene(std::move(scene));
  for (const link::StatusMessage& status : inbox->statuses()) {
    for (const link::RobotStatusMessage& robot : status.robots) {
      keeper->receive({.robot = RobotId(robot.robot_id),
                       .position_m = {robot.x_m, robot.y_m},
                       .arrived = robot.arrived,
                       .lag_s = robot.lag_s,
                       .plan_version = status.plan_version,
                       .plan_time_s = status.plan_time_s},
                      robot.mode == RobotMode::kMoving, now);
    }
  }
}

// A planner that does not lead neither plans nor beats, and has no plan on the bus: robots that
// join late receive that of the leading one alone.
void PlannerProcess::Impl::watch_rivals(SteadyTime now) {
  for (const link::HeartbeatMessage& beat : inbox->heartbeats()) {
    rivals->on_heartbeat(beat.epoch, now);
  }
  const bool led_before = rivals->role() != RivalWatch::Role::kJoining;
  const auto role = rivals->step(now);
  if (role == RivalWatch::Role::kStandingBy) {
    plan_writer.reset();
    heartbeats->pause();
    announce(link::Severity::kWarning, "planner-standby",
             "another planner leads the robots: this one stands by");
  } else if (role == RivalWatch::Role::kLeading && led_before) {
    announce(link::Severity::kWarning, "planner-takeover",
             "the planner that led the robots is silent: this one takes over");
    take_over(now);
  }
}

// Like a planner that has just been started, in the scene as it is now.
void PlannerProcess::Impl::take_over(SteadyTime now) {
  Scene scene = keeper->scene();
  Result<void> made = make_keeper();
  if (made) made = keeper->plan_first();
  if (made) made = make_plan_writer();
  if (!made) announce(link::Severity::kWarning, "replan-failed", made.error().message);
  keeper->begin(now);
  keeper->take_scene(std::move(scene));
  rivals->begin_epoch(epoch.value());
  heartbeats->begin_epoch(epoch);
}

// One step of the keeper: events, the plan and the clock go out in this order. A new clock reading
// also sends a heartbeat at once. While the keeper plans, heartbeats go on: see HeartbeatThread.
void PlannerProcess::Impl::keep_planned(SteadyTime now) {
  const UtcTime utc = utc_now();
  keeper->on_published(heartbeats->published());
  const PlanKeeper::Step step = keeper->step(now, utc);
  for (const PlanKeeper::Notice& notice : step.notices) {
    announce(notice.warning ? link::Severity::kWarning : link::Severity::kInfo, notice.code,
             notice.text);
  }
  if (step.publish) publish();
  heartbeats->on_step({.phase = inbox->phase(),
                       .t0_utc_ns = inbox->t0_utc_ns(),
                       .clock = keeper->clock(utc),
                       .at = now});
  if (!step.clock) return;
  clock_file->push(plan_clock_line(*step.clock));
  heartbeats->beat();  // robots need not wait for the next one
}

// Sends the plan, then queues it for the run directory, which keeps the first and the newest ones.
// The version of a scene is its time stamp, which gives the delay since the change.
void PlannerProcess::Impl::publish() {
  const UtcTime now = utc_now();
  const Replan& newest = keeper->newest();
  const std::uint32_t version = keeper->version();
  const std::uint64_t scene = keeper->scene().version;
  link::PlanMessage message =
      link::to_message(newest.planned.plan, epoch, PlanVersion(version), now);
  message.scene_version = scene;
  message.excess_m = newest.planned.excess.by_m;
  for (const PlanEntry& entry : newest.entries) {
    message.entries.push_back({entry.source, entry.share});
  }
  plan_writer->write(message);
  const PlanStats& stats = newest.planned.stats;
  const double after_ms =
      1e-6 * static_cast<double>(now.time_since_epoch().count() - static_cast<std::int64_t>(scene));
  announce(link::Severity::kInfo, "planned",
           fmt::format("version {}: {} nodes, {} legs, {:.1f} m mean path, {:.1f} ms{}", version,
                       newest.planned.plan.nodes().size(), newest.planned.plan.legs().size(),
                       stats.planned_mean_path_m, stats.total_ms,
                       scene == 0 ? "" : fmt::format(", {:.1f} ms after the change", after_ms)));
  if (version == 1) return;  // the mission's first plan, kept when it was made
  files.replace(plan_file(options.run_dir, version),
                to_json(newest.planned.plan, newest.planned.excess.by_m));
  if (const std::uint32_t old = outdated_plan(version)) {
    files.remove(plan_file(options.run_dir, old));
  }
}

void PlannerProcess::Impl::watch_files(SteadyTime now) {
  if (now < next_look) return;
  next_look = now + kFilesEvery;
  if (const auto event = file_watch.step(files.health(now))) {
    announce(event->is_warning ? link::Severity::kWarning : link::Severity::kInfo,
             std::string(event->code), event->text);
  }
}

void PlannerProcess::Impl::finish_files() {
  const auto losses = files.finish();
  for (const shell::FileLoss& loss : losses) {
    announce(link::Severity::kWarning, std::string(shell::kRecordsLost), describe(loss));
  }
  if (!losses.empty()) sleep_for(kLinger);
}

void PlannerProcess::Impl::announce(link::Severity severity, const std::string& code,
                                    const std::string& text) {
  event_writer->write({.severity = severity,
                       .source = link::kPlannerSource,
                       .stamp_utc_ns = utc_now().time_since_epoch().count(),
                       .code = code,
                       .text = text});
}

// Refused messages are reported a few times a second, so that a flood of them makes few events.
void PlannerProcess::Impl::report_refusals() {
  link::report_new(inbox->refused(), reported,
                   [&](link::RefusalReason reason, std::uint32_t times) {
                     announce(link::Severity::kWarning, "refused",
                              fmt::format("{} message(s): {}", times, link::to_string(reason)));
                   });
}

PlannerProcess::PlannerProcess(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PlannerProcess::~PlannerProcess() = default;

Result<std::unique_ptr<PlannerProcess>> PlannerProcess::make(const ProcessOptions& options,
                                                             const PlanningRegistry& registry) {
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  if (auto goes_on = shell::check_run_goes_on(options.run_dir); !goes_on) {
    return tl::unexpected(goes_on.error());
  }
  auto inputs = shell::read_run_inputs(options.run_dir, options.inputs, registry.catalogue());
  if (!inputs) return tl::unexpected(inputs.error());
  const shell::RunInfo& run = inputs->run;
  shell::follow(run.clock);
  impl->mission = std::move(inputs->mission);
  impl->registry = &registry;
  impl->seed = run.seed;
  if (auto made = impl->make_keeper(); !made) return tl::unexpected(made.error());
  if (auto planned = impl->plan_first(); !planned) return tl::unexpected(planned.error());
  if (auto joined = impl->join(run); !joined) return tl::unexpected(joined.error());
  return std::unique_ptr<PlannerProcess>(new PlannerProcess(std::move(impl)));
}

// Polls every kStep. A planner whose launcher has died ends: its parent process is then another
// one.
Result<void> PlannerProcess::run() {
  Impl& p = *impl_;
  const Duration period = from_seconds(1.0 / p.mission.timing.heartbeat_hz);
  SteadyTime next_report = std::chrono::steady_clock::now();
  while (shell::stop_requests() == 0) {
    const SteadyTime now = std::chrono::steady_clock::now();
    p.receive(now);
    p.watch_rivals(now);
    if (p.rivals->role() == RivalWatch::Role::kLeading && p.plan_writer) p.keep_planned(now);
    p.watch_files(now);
    if (now >= next_report) {
      p.report_refusals();
      next_report = std::max(next_report + period, now);
    }
    if (p.options.parent_pid != 0 &&
        static_cast<std::uint32_t>(::getppid()) != p.options.parent_pid)
      break;
    sleep_for(kStep);
  }
  p.finish_files();
  return {};
}

}  // namespace swarm::planner
