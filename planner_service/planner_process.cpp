// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/planner_process.hpp"

#include <algorithm>
#include <ctime>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "planner_service/planner.hpp"
#include "planner_service/replan.hpp"
#include "planner_service/robot_watch.hpp"
#include "swarm_core/mission/mission_file.hpp"
#include "swarm_core/mission/phase.hpp"
#include "swarm_core/plan/plan_json.hpp"
#include "swarm_core/shell/run_directory.hpp"
#include "swarm_core/shell/stop_signal.hpp"
#include "swarm_link/fastdds/fastdds_participant.hpp"
#include "swarm_link/topics.hpp"
#include "swarm_link/validation.hpp"

namespace swarm::planner {
namespace {

// A change of the scene must be a plan on the bus within 100 ms, most of which is not ours.
constexpr Duration kStep = std::chrono::milliseconds(5);
// After a start the launcher's scene is due at once; a bus that does not bring it must not keep a
// mission from flying.
constexpr Duration kScenePatience = std::chrono::seconds(3);
// A planner that comes back in mid-flight waits this long for robots it does not hear.
constexpr Duration kHearPatience = std::chrono::milliseconds(1500);
// Robots that stand for this long are stuck; kicks of their own have not helped by then.
constexpr Duration kStuckAfter = std::chrono::seconds(8);
// … and so many of them are reason to lead the swarm another way.
constexpr double kStuckShare = 0.1;
// While obstacles move, and while there is no plan for the scene.
constexpr Duration kReplanPeriod = std::chrono::seconds(2);

UtcTime utc_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

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
  std::uint64_t seed = 0;
  std::optional<Planner> planner;
  Scene scene;
  bool scene_heard = false;
  Replan newest;
  bool published = false;
  std::uint32_t version = 0;
  std::uint64_t planned_scene = 0;
  std::uint64_t failed_scene = 0;  // that was complained about
  PlannerEpoch epoch;
  std::unique_ptr<link::Participant> participant;
  link::WriterPtr<link::PlanMessage> plan_writer;
  link::WriterPtr<link::HeartbeatMessage> heartbeat_writer;
  link::WriterPtr<link::EventMessage> event_writer;
  link::ReaderPtr<link::CommandMessage> command_reader;
  link::ReaderPtr<link::SceneMessage> scene_reader;
  link::ReaderPtr<link::StatusMessage> status_reader;
  link::WireLimits limits;
  std::optional<RobotWatch> robots;
  MissionPhase phase = MissionPhase::kReady;
  std::uint64_t last_command = 0;
  std::int64_t t0_utc_ns = 0;
  std::uint64_t beats = 0;
  link::RefusalCounters refused;
  std::uint64_t refusals_told = 0;
  SteadyTime joined_at;
  SteadyTime tried_at;  // to plan anew
  std::vector<link::CommandMessage> commands;
  std::vector<link::SceneMessage> scenes;
  std::vector<link::StatusMessage> statuses;

  Result<void> plan_first();
  Result<void> join(const shell::RunInfo& run);
  void obey();
  void hear_scene(UtcTime now);
  void hear_robots(SteadyTime now);
  void keep_planned(SteadyTime now);
  bool is_step_due(SteadyTime now) const;
  Result<Replan> plan_anew(UtcTime now, std::span<const HeardRobot> heard);
  void try_again(SteadyTime now);
  void avoid_jams(SteadyTime now);
  void publish();
  void announce(link::Severity severity, const std::string& code, const std::string& text);
  void beat(UtcTime now);
};

Result<void> PlannerProcess::Impl::plan_first() {
  Rng rng(seed);
  planner.emplace(planner_options(mission.planner, mission.robots.count));
  auto planned = planner->plan({mission.world, mission.start, mission.goal}, rng,
                               &std::chrono::steady_clock::now);
  if (!planned) return tl::unexpected(planned.error());
  newest = {*std::move(planned), {}};
  if (auto w = shell::write_file(options.run_dir / shell::kPlanFile, to_json(newest.planned.plan));
      !w) {
    return w;
  }
  return write_stats(options.run_dir, newest.planned.stats);
}

Result<void> PlannerProcess::Impl::join(const shell::RunInfo& run) {
  auto made = link::make_fastdds_participant({.name = "planner_service",
                                              .domain = run.domain,
                                              .index = options.participant_index,
                                              .discovery = {run.discovery_host, run.discovery_port},
                                              .ownership_strength = options.ownership_strength});
  if (!made) return tl::unexpected(made.error());
  participant = std::move(*made);
  if (auto hears = participant->self_check(); !hears) return hears;
  auto plans = participant->make_writer(link::plan_topic());
  auto heartbeats = participant->make_writer(link::heartbeat_topic());
  auto events = participant->make_writer(link::event_topic());
  auto orders = participant->make_reader(link::command_topic());
  auto scene_changes = participant->make_reader(link::scene_topic());
  auto health = participant->make_reader(link::status_topic_unacknowledged());
  if (!plans) return tl::unexpected(plans.error());
  if (!heartbeats) return tl::unexpected(heartbeats.error());
  if (!events) return tl::unexpected(events.error());
  if (!orders) return tl::unexpected(orders.error());
  if (!scene_changes) return tl::unexpected(scene_changes.error());
  if (!health) return tl::unexpected(health.error());
  plan_writer = std::move(*plans);
  heartbeat_writer = std::move(*heartbeats);
  event_writer = std::move(*events);
  command_reader = std::move(*orders);
  scene_reader = std::move(*scene_changes);
  status_reader = std::move(*health);
  limits = link::wire_limits(mission);
  robots.emplace(mission.robots.count, from_seconds(3.0 + 3.0 / mission.link.status_hz));
  joined_at = std::chrono::steady_clock::now();
  return {};
}

/// t0 is the stamp of the start command, which the launcher keeps for late joiners: a restarted
/// planner finds it again.
void PlannerProcess::Impl::obey() {
  commands.clear();
  command_reader->take(commands);
  for (const link::CommandMessage& command : commands) {
    if (const auto ok = link::check_command(command); !ok) {
      refused.count(ok.error());
      continue;
    }
    if (command.command_id <= last_command && command.kind != CommandKind::kStop) continue;
    last_command = std::max(last_command, command.command_id);
    const MissionPhase before = phase;
    phase = phase_after(phase, command.kind);
    if (before == MissionPhase::kReady && phase == MissionPhase::kRunning)
      t0_utc_ns = command.stamp_utc_ns;
  }
}

void PlannerProcess::Impl::hear_scene(UtcTime now) {
  scenes.clear();
  scene_reader->take(scenes);
  const auto newest_possible =
      static_cast<std::uint64_t>((now + limits.clock_skew_refuse).time_since_epoch().count());
  for (const link::SceneMessage& message : scenes) {
    auto heard = link::check_scene(message);
    if (!heard) {
      refused.count(heard.error());
    } else if (heard->version > newest_possible) {
      refused.count(link::RefusalReason::kForged);
    } else if (scene_heard && heard->version <= scene.version) {
      refused.count(link::RefusalReason::kStale);
    } else {
      scene = std::move(*heard);
      scene_heard = true;
    }
  }
}

void PlannerProcess::Impl::hear_robots(SteadyTime now) {
  statuses.clear();
  status_reader->take(statuses);
  for (const link::StatusMessage& status : statuses) {
    if (const auto ok = link::check_status(status, limits); !ok) {
      refused.count(ok.error());
      continue;
    }
    robots->hear({.robot = RobotId(status.robot_id),
                  .position_m = {status.x_m, status.y_m},
                  .arrived = status.arrived},
                 status.mode == RobotMode::kMoving, now);
  }
}

/// From where the robots are, once they have left their start; before, the mission's own mixture is
/// the truth they were placed by.
Result<Replan> PlannerProcess::Impl::plan_anew(UtcTime now, std::span<const HeardRobot> heard) {
  const World world = world_during(mission.world, scene, now, kReplanPeriod);
  const Mixture& goal = scene.goal ? *scene.goal : mission.goal;
  planner->set_risk({.alpha = scene.risk_alpha.value_or(mission.planner.risk_alpha),
                     .delta_m = mission.planner.risk_delta_m});
  Rng rng(mix_seed(seed, version));
  if (phase != MissionPhase::kReady) {
    return replan(*planner, world, goal, heard, mission.robots.count, rng,
                  &std::chrono::steady_clock::now);
  }
  auto planned = planner->plan({world, mission.start, goal}, rng, &std::chrono::steady_clock::now);
  if (!planned) return tl::unexpected(planned.error());
  return Replan{*std::move(planned), {}};
}

void PlannerProcess::Impl::try_again(SteadyTime now) {
  const std::vector<HeardRobot> heard = robots->fresh(now);
  if (phase != MissionPhase::kReady) {
    if (heard.empty() || (!robots->heard_all(now) && now - joined_at < kHearPatience)) return;
  }
  tried_at = now;
  auto planned = plan_anew(utc_now(), heard);
  if (!planned) {
    if (failed_scene == scene.version) return;
    failed_scene = scene.version;
    std::string why = planned.error().message;
    for (std::size_t at = 0; (at = why.find('\n', at)) != std::string::npos;) {
      why.replace(at, 1, "; ");  // an event is one line
    }
    announce(link::Severity::kWarning, "replan-failed", "the last plan stays: " + why);
    return;
  }
  newest = *std::move(planned);
  publish();
}

/// There is to be a plan on the bus for the scene as it is; anew while obstacles move, and, with
/// ROVER, for every step it takes.
void PlannerProcess::Impl::keep_planned(SteadyTime now) {
  if (!scene_heard && now - joined_at < kScenePatience) return;
  if (scene.version == 0 && !published) {
    publish();
    tried_at = now;
    return;
  }
  const bool news = !published || scene.version != planned_scene;
  const bool tried = failed_scene == scene.version;
  const bool due = now - tried_at >= kReplanPeriod;
  if ((news && (!tried || due)) || (scene.moves(utc_now()) && due) || is_step_due(now)) {
    try_again(now);
  }
}

bool PlannerProcess::Impl::is_step_due(SteadyTime now) const {
  if (mission.planner.method != "rover" || phase != MissionPhase::kRunning) return false;
  const double step_s = mission.planner.transport_radius_m / mission.planner.speed_mps;
  if (now - tried_at < from_seconds(step_s)) return false;
  const std::vector<HeardRobot> heard = robots->fresh(now);
  return std::any_of(heard.begin(), heard.end(), [](const HeardRobot& r) { return !r.arrived; });
}

/// CRoPS: where many are stuck the guide becomes dear, and may lead another way.
void PlannerProcess::Impl::avoid_jams(SteadyTime now) {
  if (phase != MissionPhase::kRunning) return;
  const std::vector<HeardRobot> stuck = robots->stuck(now, kStuckAfter);
  if (stuck.empty() || static_cast<double>(stuck.size()) < kStuckShare * mission.robots.count) {
    return;
  }
  robots->forgive(now);
  const Vec2& at_m = stuck[stuck.size() / 2].position_m;
  if (!planner->avoid(at_m)) return;
  announce(link::Severity::kInfo, "jam",
           fmt::format("{} robots are stuck, about ({:.1f}, {:.1f}) m: the guide leads another way",
                       stuck.size(), at_m.x(), at_m.y()));
  try_again(now);
}

void PlannerProcess::Impl::publish() {
  const UtcTime now = utc_now();
  link::PlanMessage message =
      link::to_message(newest.planned.plan, epoch, PlanVersion(++version), now);
  message.scene_version = scene.version;
  for (const PlanEntry& entry : newest.entries) {
    message.entries.push_back({entry.source, entry.share});
  }
  plan_writer->write(message);
  published = true;
  planned_scene = scene.version;
  const PlanStats& stats = newest.planned.stats;
  const double after_ms = 1e-6 * static_cast<double>(now.time_since_epoch().count() -
                                                     static_cast<std::int64_t>(scene.version));
  announce(
      link::Severity::kInfo, "planned",
      fmt::format("version {}: {} nodes, {} legs, {:.1f} m mean path, {:.1f} ms{}", version,
                  newest.planned.plan.nodes().size(), newest.planned.plan.legs().size(),
                  stats.planned_mean_path_m, stats.total_ms,
                  scene.version == 0 ? "" : fmt::format(", {:.1f} ms after the change", after_ms)));
  if (version == 1 && scene.version == 0) return;  // kept when it was made
  const auto kept = shell::write_file(options.run_dir / fmt::format("plan-{:04}.json", version),
                                      to_json(newest.planned.plan));
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

void PlannerProcess::Impl::beat(UtcTime now) {
  if (const std::uint64_t total = refused.total(); total > refusals_told) {
    announce(link::Severity::kWarning, "refused", fmt::format("{} message(s) so far", total));
    refusals_told = total;
  }
  const std::int64_t stamp = now.time_since_epoch().count();
  const double mission_time_s =
      t0_utc_ns == 0 ? 0.0 : 1e-9 * static_cast<double>(stamp - t0_utc_ns);
  heartbeat_writer->write({.phase = phase,
                           .version = version,
                           .epoch = epoch.value(),
                           .sequence_number = ++beats,
                           .stamp_utc_ns = stamp,
                           .mission_time_s = mission_time_s});
}

PlannerProcess::PlannerProcess(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PlannerProcess::~PlannerProcess() = default;

Result<std::unique_ptr<PlannerProcess>> PlannerProcess::make(const ProcessOptions& options) {
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  const auto run = shell::read_run_info(options.run_dir);
  if (!run) return tl::unexpected(run.error());
  auto mission = load_mission(options.run_dir / shell::kMissionFile);
  if (!mission) return tl::unexpected(mission.error());
  impl->mission = std::move(*mission);
  impl->seed = run->seed;
  impl->scene = first_scene(impl->mission.world.obstacles().size());
  impl->epoch = PlannerEpoch(static_cast<std::uint64_t>(utc_now().time_since_epoch().count()));
  if (auto planned = impl->plan_first(); !planned) return tl::unexpected(planned.error());
  if (auto joined = impl->join(*run); !joined) return tl::unexpected(joined.error());
  return std::unique_ptr<PlannerProcess>(new PlannerProcess(std::move(impl)));
}

Result<void> PlannerProcess::run() {
  Impl& p = *impl_;
  const Duration beat_period = from_seconds(1.0 / p.mission.timing.heartbeat_hz);
  SteadyTime next_beat = std::chrono::steady_clock::now();
  while (shell::stop_requests() == 0) {
    p.participant->receive();
    const SteadyTime now = std::chrono::steady_clock::now();
    p.obey();
    p.hear_scene(utc_now());
    p.hear_robots(now);
    p.keep_planned(now);
    p.avoid_jams(now);
    if (now >= next_beat) {
      p.beat(utc_now());
      next_beat = std::max(next_beat + beat_period, now);
    }
    if (p.options.parent_pid != 0 &&
        static_cast<std::uint32_t>(::getppid()) != p.options.parent_pid)
      break;
    sleep_for(kStep);
  }
  return {};
}

}  // namespace swarm::planner
