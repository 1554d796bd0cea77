// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/planner_process.hpp"

#include <ctime>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "planner_service/planner.hpp"
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

constexpr Duration kStep = std::chrono::milliseconds(20);

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
  FlowPlan plan;
  PlannerEpoch epoch;
  std::unique_ptr<link::Participant> participant;
  link::WriterPtr<link::PlanMessage> plan_writer;
  link::WriterPtr<link::HeartbeatMessage> heartbeat_writer;
  link::WriterPtr<link::EventMessage> event_writer;
  link::ReaderPtr<link::CommandMessage> command_reader;
  MissionPhase phase = MissionPhase::kReady;
  std::uint64_t last_command = 0;
  std::int64_t t0_utc_ns = 0;
  std::uint64_t beats = 0;
  std::uint32_t refused = 0;
  std::vector<link::CommandMessage> commands;

  Result<void> join(const shell::RunInfo& run);
  void obey();
  void beat(UtcTime now);
};

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
  if (!plans) return tl::unexpected(plans.error());
  if (!heartbeats) return tl::unexpected(heartbeats.error());
  if (!events) return tl::unexpected(events.error());
  if (!orders) return tl::unexpected(orders.error());
  plan_writer = std::move(*plans);
  heartbeat_writer = std::move(*heartbeats);
  event_writer = std::move(*events);
  command_reader = std::move(*orders);
  return {};
}

/// t0 is the stamp of the start command, which the launcher keeps for late joiners: a restarted
/// planner finds it again.
void PlannerProcess::Impl::obey() {
  commands.clear();
  command_reader->take(commands);
  for (const link::CommandMessage& command : commands) {
    if (!link::check_command(command)) {
      ++refused;
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

void PlannerProcess::Impl::beat(UtcTime now) {
  const std::int64_t stamp = now.time_since_epoch().count();
  const double mission_time_s =
      t0_utc_ns == 0 ? 0.0 : 1e-9 * static_cast<double>(stamp - t0_utc_ns);
  heartbeat_writer->write({.phase = phase,
                           .version = 1,
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

  Rng rng(run->seed);
  auto planned = plan({impl->mission.world, impl->mission.start, impl->mission.goal},
                      planner_options(impl->mission.planner), rng, &std::chrono::steady_clock::now);
  if (!planned) return tl::unexpected(planned.error());
  impl->plan = std::move(planned->plan);
  impl->epoch = PlannerEpoch(static_cast<std::uint64_t>(utc_now().time_since_epoch().count()));
  if (auto w = shell::write_file(options.run_dir / shell::kPlanFile, to_json(impl->plan)); !w) {
    return tl::unexpected(w.error());
  }
  if (auto w = write_stats(options.run_dir, planned->stats); !w) return tl::unexpected(w.error());
  if (auto joined = impl->join(*run); !joined) return tl::unexpected(joined.error());

  const UtcTime now = utc_now();
  impl->plan_writer->write(link::to_message(impl->plan, impl->epoch, PlanVersion(1), now));
  impl->event_writer->write(
      {.source = link::kPlannerSource,
       .stamp_utc_ns = now.time_since_epoch().count(),
       .code = "planned",
       .text = fmt::format("{} nodes, {} legs, {:.1f} m mean path, {:.1f} ms",
                           impl->plan.nodes().size(), impl->plan.legs().size(),
                           planned->stats.planned_mean_path_m, planned->stats.total_ms)});
  return std::unique_ptr<PlannerProcess>(new PlannerProcess(std::move(impl)));
}

Result<void> PlannerProcess::run() {
  Impl& p = *impl_;
  const Duration beat_period = from_seconds(1.0 / p.mission.timing.heartbeat_hz);
  SteadyTime next_beat = std::chrono::steady_clock::now();
  while (shell::stop_requests() == 0) {
    p.participant->receive();
    p.obey();
    const SteadyTime now = std::chrono::steady_clock::now();
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
