// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/program/planner_process.hpp"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "planner_service/keeper/plan_keeper.hpp"
#include "planner_service/program/heartbeat_thread.hpp"
#include "planner_service/program/planner_inbox.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/app/run_membership.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_core/plan/plan_json.hpp"
#include "swarm_core/plan/planning_record.hpp"
#include "swarm_link/roles/run_meeting.hpp"
#include "swarm_link/to_message.hpp"
#include "swarm_link/topics.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::planner {
namespace {

// A change of the scene must lead to a published plan within 100 ms; polling may take only a small
// part of that.
constexpr Duration kStep = std::chrono::milliseconds(5);
// A plan takes as long as the mission waits for the first one, or this time if that is longer. The
// planner hangs if it takes longer.
constexpr double kLongestPlan_s = 30.0;
constexpr std::uint64_t kFaultSeed = 0xFA17;  // own random numbers for the link

// std::this_thread::sleep_for would sleep on after a signal.
void sleep_for(Duration d) {
  const timespec t{.tv_sec = 0, .tv_nsec = static_cast<long>(d.count())};
  ::nanosleep(&t, nullptr);  // a stop signal wakes it
}

Result<void> write_stats(const std::filesystem::path& run_dir, const PlanStats& stats) {
  const nlohmann::ordered_json json = {{"nodes", stats.nodes},
                                       {"edges", stats.edges},
                                       {"roadmap_ms", stats.roadmap_ms},
                                       {"search_ms", stats.search_ms},
                                       {"transport_ms", stats.transport_ms},
                                       {"smoothing_ms", stats.smoothing_ms},
                                       {"total_ms", stats.total_ms},
                                       {"planned_mean_path_m", stats.planned_mean_path_m}};
  return shell::write_file(run_dir / shell::kPlanStatsFile, json.dump(2) + "\n");
}

}  // namespace

struct PlannerProcess::Impl {
  ProcessOptions options;
  Mission mission;
  std::optional<PlanKeeper> keeper;
  PlannerEpoch epoch;
  std::unique_ptr<link::Participant> participant;
  link::WriterPtr<link::PlanMessage> plan_writer;
  link::WriterPtr<link::EventMessage> event_writer;
  std::optional<PlannerInbox> inbox;
  std::optional<HeartbeatThread> heartbeats;  // after the participant: it ends first
  std::ofstream clock_file;
  link::RefusalCounters reported;      // counts already announced as events
  std::vector<std::string> unwritten;  // why files of the first plan are missing

  Result<void> plan_first();
  Result<void> join(const shell::RunInfo& run);
  void receive(SteadyTime now);
  void keep_planned(SteadyTime now);
  void publish();
  void announce(link::Severity severity, const std::string& code, const std::string& text);
  void report_refusals();
};

// Writes plan and statistics to the run directory before the planner joins the bus. A file that
// cannot be written, as on a full disk, is reported and does not keep robots waiting for the plan.
Result<void> PlannerProcess::Impl::plan_first() {
  const auto keep = [this](const Result<void>& written) {
    if (!written) unwritten.push_back(written.error().message);
  };
  const PlanningRecord promised{mission.planner.method,
                                keeper->method().traits().density_cap_per_m2};
  keep(shell::write_file(options.run_dir / shell::kPlanningFile, to_json(promised)));
  if (auto planned = keeper->plan_first(); !planned) return planned;
  const PlanResult& planned = keeper->newest().planned;
  keep(shell::write_file(options.run_dir / shell::kPlanFile, to_json(planned.plan)));
  keep(write_stats(options.run_dir, planned.stats));
  return {};
}

// Creates all writers and readers first and takes them over only when none failed.
Result<void> PlannerProcess::Impl::join(const shell::RunInfo& run) {
  auto made = link::join_as_planner(link::meeting_of(run, {.faults = options.faults,
                                                           .seed = mix_seed(run.seed, kFaultSeed),
                                                           .run_began = run.began}),
                                    options.ownership_strength);
  if (!made) return tl::unexpected(made.error());
  participant = std::move(*made);
  auto plans = participant->make_writer(link::plan_topic());
  auto beats = participant->make_writer(link::heartbeat_topic());
  auto events = participant->make_writer(link::event_topic());
  auto orders = participant->make_reader(link::command_topic());
  auto scene_changes = participant->make_reader(link::scene_topic());
  auto health = participant->make_reader(link::status_topic_unacknowledged());
  if (!plans) return tl::unexpected(plans.error());
  if (!beats) return tl::unexpected(beats.error());
  if (!events) return tl::unexpected(events.error());
  if (!orders) return tl::unexpected(orders.error());
  if (!scene_changes) return tl::unexpected(scene_changes.error());
  if (!health) return tl::unexpected(health.error());
  plan_writer = std::move(*plans);
  event_writer = std::move(*events);
  inbox.emplace(Readers{std::move(*orders), std::move(*scene_changes), std::move(*health)},
                link::wire_limits(mission));
  clock_file.open(options.run_dir / shell::kPlanClockFile, std::ios::app);
  for (const std::string& reason : unwritten) {
    announce(link::Severity::kWarning, "plan-file-missing", reason);
  }
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
  clock_file << plan_clock_line(*step.clock) << std::flush;
  heartbeats->beat();  // robots need not wait for the next one
}

// Sends the plan, then writes it to the run directory, since the file must not delay the robots.
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
  if (version == 1 && scene == 0) return;  // kept when it was made
  const auto kept = shell::write_file(options.run_dir / fmt::format("plan-{:04}.json", version),
                                      to_json(newest.planned.plan, newest.planned.excess.by_m));
  if (!kept) announce(link::Severity::kWarning, "plan-file", kept.error().message);
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

// The epoch is the start time of the process, so that the plans of a restarted planner supersede
// those before.
Result<std::unique_ptr<PlannerProcess>> PlannerProcess::make(const ProcessOptions& options,
                                                             const PlanningRegistry& registry) {
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  if (auto goes_on = shell::check_run_goes_on(options.run_dir); !goes_on) {
    return tl::unexpected(goes_on.error());
  }
  const auto run = shell::read_run_info(options.run_dir);
  if (!run) return tl::unexpected(run.error());
  auto mission = load_mission(options.run_dir / shell::kMissionFile, registry.catalogue());
  if (!mission) return tl::unexpected(mission.error());
  impl->mission = std::move(*mission);
  auto planner = Planner::make(registry, impl->mission);
  if (!planner) return tl::unexpected(planner.error());
  impl->keeper.emplace(impl->mission, *std::move(planner), run->seed,
                       &std::chrono::steady_clock::now);
  impl->epoch = PlannerEpoch(static_cast<std::uint64_t>(utc_now().time_since_epoch().count()));
  if (auto planned = impl->plan_first(); !planned) return tl::unexpected(planned.error());
  if (auto joined = impl->join(*run); !joined) return tl::unexpected(joined.error());
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
    p.keep_planned(now);
    if (now >= next_report) {
      p.report_refusals();
      next_report = std::max(next_report + period, now);
    }
    if (p.options.parent_pid != 0 &&
        static_cast<std::uint32_t>(::getppid()) != p.options.parent_pid)
      break;
    sleep_for(kStep);
  }
  return {};
}

}  // namespace swarm::planner
