// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/agent_process.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <ctime>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "robot_agent/control/density_attraction.hpp"
#include "robot_agent/drivers/simulated_robot.hpp"
#include "robot_agent/inbox.hpp"
#include "robot_agent/robot.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_core/mission/mission_file.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarm_core/mission/scene_bodies.hpp"
#include "swarm_core/shell/run_directory.hpp"
#include "swarm_core/shell/stop_signal.hpp"
#include "swarm_link/groups/group_channel.hpp"
#include "swarm_link/run_meeting.hpp"
#include "swarm_link/topics.hpp"

namespace swarm::agent {
namespace {

// So that a body's noise and the network's faults are not the agent's chance.
constexpr std::uint64_t kBodySeed = 0xB0D7;
constexpr std::uint64_t kFaultSeed = 0xFA17;

/// Robots that tell their health together, where a process has so many.
constexpr std::size_t kStatusGroup = 100;
constexpr Duration kStatsEvery = std::chrono::seconds(1);
constexpr Duration kClockPatience = std::chrono::seconds(1);

/// A black box is written at every step, so that nothing is lost with a process that is killed. In
/// one of many robots that would be most of its time: each of their boxes is written once a second.
constexpr std::uint32_t kManyRobots = 20;
constexpr std::uint32_t kRecordsAtOnce = 10;

/// Sleeps until `at`; false when a signal woke us early.
bool sleep_until(SteadyTime at) {
  const auto ns = at.time_since_epoch().count();
  const timespec when{.tv_sec = static_cast<time_t>(ns / 1'000'000'000),
                      .tv_nsec = static_cast<long>(ns % 1'000'000'000)};
  return ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr) != EINTR;
}

/// A respawned robot's body stands where its black box last saw it; a new one at its place in the
/// mission.
Result<Vec2> standing_place(const std::filesystem::path& box_file, const Vec2& placed_m) {
  const auto last = blackbox::last_steps(box_file);
  if (!last) return tl::unexpected(last.error());
  return last->empty() ? placed_m : last->back().position_m;
}

}  // namespace

struct AgentProcess::Impl {
  ProcessOptions options;
  Mission mission;
  World world;  // as it stands now; the robots refer to it
  Scene scene;
  bool world_moves = false;
  std::unique_ptr<link::Participant> participant;
  std::unique_ptr<link::StateChannel> states;
  link::WriterPtr<link::StatusMessage> status_writer;
  link::WriterPtr<link::EventMessage> event_writer;
  std::optional<Inbox> inbox;
  std::vector<Robot> robots;
  Histogram state_age;  // of what all of them used
  std::vector<link::RobotStateMessage> saying;
  std::vector<Vec2> positions;
  link::StatusMessage health;      // kept for its memory
  link::RefusalCounters reported;  // what was announced as an event already
  std::uint32_t skewed_reported = 0;
  std::uint32_t plan_told = 0;
  bool planner_was_alive = false;
  bool boxes_dropped = false;  // told already
  SteadyTime stats_at;
  std::size_t ticks = 0;
  bool is_underway = false;  // some robot was restarted in mid-flight
  std::optional<NewPlan> waiting_plan;
  SteadyTime plan_waits_since;
  FlowPlan flow;  // in force, where planned_density is asked for
  PlannedDensity planned_density;

  Result<void> join(const shell::RunInfo& run);
  Result<void> make_robots(std::uint64_t seed);
  std::optional<NewPlan> take_plan(const Robot::Tick& tick);
  void follow_density(const std::optional<NewPlan>& new_plan, Robot::Tick& tick);
  void tick(Robot::Tick tick);
  void follow_scene(UtcTime now);
  void report_health(const Robot::Tick& tick);
  bool status_is_due(std::size_t first) const;
  void tell_status(std::size_t first, UtcTime now);
  std::span<const Robot> group(std::size_t first) const;
  void announce(UtcTime now, link::Severity severity, const std::string& code,
                const std::string& text);
  void record_link_stats(UtcTime now);
};

Result<void> AgentProcess::Impl::join(const shell::RunInfo& run) {
  const link::ReceptionFaults faults{
      .faults = options.faults,
      .seed = mix_seed(mix_seed(run.seed, kFaultSeed), options.number + 1),
      .run_began = run.began};
  auto made = link::join_as_agent(link::meeting_of(run, faults), options.number,
                                  fmt::format("robot_agent_{}", options.first.value()),
                                  options.vendor, options.by_gateway);
  if (!made) return tl::unexpected(made.error());
  participant = std::move(*made);

  auto plan_reader = participant->make_reader(link::plan_topic());
  auto scene_reader = participant->make_reader(link::scene_topic());
  auto heartbeat_reader = participant->make_reader(link::heartbeat_topic());
  auto command_reader = participant->make_reader(link::command_topic());
  auto status = participant->make_writer(link::status_topic());
  auto event = participant->make_writer(link::event_topic());
  if (!plan_reader) return tl::unexpected(plan_reader.error());
  if (!scene_reader) return tl::unexpected(scene_reader.error());
  if (!heartbeat_reader) return tl::unexpected(heartbeat_reader.error());
  if (!command_reader) return tl::unexpected(command_reader.error());
  if (!status) return tl::unexpected(status.error());
  if (!event) return tl::unexpected(event.error());
  status_writer = std::move(*status);
  event_writer = std::move(*event);

  const LinkSpec& l = mission.link;
  if (run.channel == Channel::kGroups && !options.by_gateway) {
    link::GroupChannelOptions groups{
        .domain = run.domain, .interface = run.interface, .faults = faults};
    groups.cells.cell_size_m = l.group_cell_size_m;
    groups.cells.hear_radius_m = l.hear_radius_m;
    auto channel = link::make_group_channel(groups);
    if (!channel) return tl::unexpected(channel.error());
    states = std::move(*channel);
  } else {
    states = link::make_topic_channel(*participant, {.cell_size_m = l.cell_size_m,
                                                     .hear_radius_m = l.hear_radius_m,
                                                     .join_margin_m = l.join_margin_m,
                                                     .leave_margin_m = l.leave_margin_m});
  }
  const link::WireLimits limits = link::wire_limits(mission);
  inbox.emplace(Readers{std::move(*plan_reader), std::move(*scene_reader),
                        std::move(*heartbeat_reader), std::move(*command_reader)},
                *states, limits,
                MissionWatch(from_seconds(mission.timing.planner_silence_s),
                             from_seconds(l.send_interval_max_s + 2.0 / mission.control.rate_hz)),
                from_seconds(mission.timing.planner_silence_s), hears_farthest_m(mission));
  return {};
}

Result<void> AgentProcess::Impl::make_robots(std::uint64_t seed) {
  const auto places = place_robots(mission, seed);
  if (!places) return tl::unexpected(places.error());
  robots.reserve(options.count);
  AgentOptionsOf options_of(mission);
  for (std::uint32_t i = 0; i < options.count; ++i) {
    const RobotId id(options.first.value() + i);
    const auto box_file = blackbox::file_of(options.run_dir, id);
    const auto place = standing_place(box_file, (*places)[id.value()]);
    if (!place) return tl::unexpected(place.error());
    auto box = options.count < kManyRobots
                   ? blackbox::Writer::open(box_file)
                   : blackbox::Writer::open(box_file, kRecordsAtOnce, id.value() % kRecordsAtOnce);
    if (!box) return tl::unexpected(box.error());
    box->append(blackbox::Header{.robot = id,
                                 .robots = mission.robots.count,
                                 .process_id = static_cast<std::uint32_t>(::getpid()),
                                 .radius_m = body_of(mission.robots, id).radius_m,
                                 .stamp = utc_now()});
    auto body = std::make_unique<SimulatedRobot>(
        make_simulated_body(body_of(mission.robots, id), std::chrono::steady_clock::now(), *place,
                            mix_seed(mix_seed(seed, id.value()), kBodySeed)));
    AgentIdentity self = agent_identity(mission, id);
    self.underway = *place != (*places)[id.value()];
    is_underway = is_underway || self.underway;
    robots.emplace_back(world, options_of(id), self, agent_rng(id, seed), std::move(body),
                        std::move(*box));
  }
  return {};
}

void AgentProcess::Impl::announce(UtcTime now, link::Severity severity, const std::string& code,
                                  const std::string& text) {
  event_writer->write({.severity = severity,
                       .source = options.first.value(),
                       .stamp_utc_ns = now.time_since_epoch().count(),
                       .code = code,
                       .text = text});
  robots.front().note(now, code, text);
}

/// The map is made anew when the scene changed, and at every tick while an obstacle moves.
void AgentProcess::Impl::follow_scene(UtcTime now) {
  if (auto news = inbox->take_scene()) {
    scene = std::move(*news);
    world_moves = true;
    robots.front().note(now, "scene", fmt::format("took scene version {}", scene.version),
                        static_cast<std::int64_t>(scene.version));
  }
  if (!world_moves) return;
  // A robot that comes back is inside its own body until the launcher receives it again.
  world = world_at(mission.world, without_bodies_of(scene, options.first, options.count), now);
  world_moves = scene.moves(now);
}

/// The newest plan, once. A robot that was restarted in mid-flight finds its place in it by the
/// plan's time, too: its process waits for the first heartbeat, but not for ever.
std::optional<NewPlan> AgentProcess::Impl::take_plan(const Robot::Tick& tick) {
  if (auto plan = inbox->take_plan()) {
    waiting_plan = std::move(plan);
    plan_waits_since = tick.now;
  }
  const bool waits = is_underway && !tick.plan_time && tick.now - plan_waits_since < kClockPatience;
  return waits ? std::nullopt : std::exchange(waiting_plan, std::nullopt);
}

/// The planned density at the plan's time, where the control method asks for it.
void AgentProcess::Impl::follow_density(const std::optional<NewPlan>& new_plan, Robot::Tick& tick) {
  if (mission.control.density_push_mps <= 0.0) return;
  if (new_plan) flow = new_plan->flow;
  if (flow.empty() || !tick.plan_time) return;
  update(planned_density, flow, tick.plan_time->plan_time_s, mission.robots.count,
         DensityAttractionOptions{}.kernel_sigma_m());
  tick.planned_density = &planned_density;
}

void AgentProcess::Impl::tick(Robot::Tick tick) {
  participant->receive();
  inbox->receive(tick.now, tick.utc_now, [this](RobotId id) -> const EchoGuard* {
    const std::uint32_t offset = id.value() - options.first.value();
    return offset < robots.size() ? &robots[offset].echo() : nullptr;
  });
  follow_scene(tick.utc_now);
  tick.plan_time = inbox->plan_time(tick.now);
  const std::optional<NewPlan> new_plan = take_plan(tick);
  follow_density(new_plan, tick);

  saying.clear();
  positions.clear();
  for (Robot& robot : robots) {
    robot.step(tick, *inbox, new_plan ? &*new_plan : nullptr, state_age);
    if (robot.to_say()) saying.push_back(*robot.to_say());
    positions.push_back(robot.position_m());
  }
  // Cell topics come after the plan: a start-up in which everyone discovers everything at once
  // takes the discovery server several times as long, and nobody moves without a plan.
  if (inbox->plan_version() > 0) {
    states->publish(saying);
    states->listen_around(positions);
  }
  report_health(tick);
}

std::span<const Robot> AgentProcess::Impl::group(std::size_t first) const {
  return std::span(robots).subspan(first, std::min(kStatusGroup, robots.size() - first));
}

/// What the process heard and refused belongs to no single robot: its first group tells it.
void AgentProcess::Impl::tell_status(std::size_t first, UtcTime now) {
  health.first_robot_id = robots[first].id().value();
  health.process_id = static_cast<std::uint32_t>(::getpid());
  health.plan_epoch = inbox->plan_epoch();
  health.plan_version = inbox->plan_version();
  health.plan_scene_version = inbox->plan_scene_version();
  health.stamp_utc_ns = now.time_since_epoch().count();
  const auto plan_time = inbox->plan_time(std::chrono::steady_clock::now());
  health.plan_time_s = plan_time ? plan_time->plan_time_s : 0.0;
  health.robots.clear();
  for (const Robot& robot : group(first)) health.robots.push_back(robot.status());
  health.refused.clear();
  health.state_age.clear();
  if (first == 0) {
    const auto& refused = inbox->refused().all();
    health.refused.assign(refused.begin(), refused.end());
    for (std::size_t i = 0; i < Histogram::kBins; ++i) {
      if (state_age.bin(i) == 0) continue;
      health.state_age.push_back(
          {static_cast<std::uint16_t>(i), static_cast<std::uint32_t>(state_age.bin(i))});
    }
  }
  status_writer->write(health);
}

void AgentProcess::Impl::record_link_stats(UtcTime now) {
  for (Robot& robot : robots) {
    const link::RobotStatusMessage counted = robot.status();
    blackbox::LinkStats stats{.stamp = now,
                              .states_sent = counted.states_sent,
                              .states_received = counted.states_received};
    if (&robot == &robots.front()) {
      stats.state_age = state_age;
      stats.refused.assign(inbox->refused().all().begin(), inbox->refused().all().end());
    }
    robot.record(stats);
  }
  const bool dropped = std::any_of(robots.begin(), robots.end(),
                                   [](const Robot& robot) { return robot.records_dropped() > 0; });
  if (dropped && !boxes_dropped) {
    announce(now, link::Severity::kWarning, "blackbox-dropped",
             "the disk does not take what the black box records; flies on without");
  }
  boxes_dropped = dropped;
}

/// Each group in its turn, so that those of one process do not all speak at the same tick.
bool AgentProcess::Impl::status_is_due(std::size_t first) const {
  const double ticks_per_status = mission.control.rate_hz / mission.link.status_hz;
  const auto turns = static_cast<std::size_t>(std::max(1.0, std::round(ticks_per_status)));
  const auto members = group(first);
  return (ticks + first / kStatusGroup) % turns == 0 ||
         std::any_of(members.begin(), members.end(),
                     [](const Robot& robot) { return robot.mode_changed(); });
}

void AgentProcess::Impl::report_health(const Robot::Tick& tick) {
  // Everyone waits for everyone to have the plan: that is told at once.
  const bool news = inbox->plan_version() != plan_told;
  plan_told = inbox->plan_version();
  for (std::size_t first = 0; first < robots.size(); first += kStatusGroup) {
    if (news || status_is_due(first)) tell_status(first, tick.utc_now);
  }
  ++ticks;
  const bool alive = inbox->mission().planner_alive(tick.now);
  if (alive != planner_was_alive) {
    announce(tick.utc_now, alive ? link::Severity::kInfo : link::Severity::kWarning,
             alive ? "planner-heard" : "planner-silent",
             alive ? "hears the planner" : "planner silent: holds with avoidance on");
    planner_was_alive = alive;
  }
  if (tick.now - stats_at < kStatsEvery) return;
  stats_at = tick.now;
  record_link_stats(tick.utc_now);
  if (const std::uint32_t fresh = inbox->skewed() - skewed_reported; fresh > 0) {
    skewed_reported += fresh;
    announce(tick.utc_now, link::Severity::kWarning, "clock-skew",
             fmt::format("{} state(s) from a clock that differs from ours", fresh));
  }
  for (std::size_t i = 0; i < link::kRefusalReasons; ++i) {
    const auto reason = static_cast<link::RefusalReason>(i);
    const std::uint32_t fresh = inbox->refused()[reason] - reported[reason];
    if (fresh == 0) continue;
    reported.count(reason, fresh);
    announce(tick.utc_now, link::Severity::kWarning, "refused",
             fmt::format("{} message(s): {}", fresh, link::to_string(reason)));
  }
}

AgentProcess::AgentProcess(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
AgentProcess::~AgentProcess() = default;

Result<std::unique_ptr<AgentProcess>> AgentProcess::make(const ProcessOptions& options) {
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  const auto run = shell::read_run_info(options.run_dir);
  if (!run) return tl::unexpected(run.error());
  auto mission = load_mission(options.run_dir / shell::kMissionFile);
  if (!mission) return tl::unexpected(mission.error());
  impl->mission = std::move(*mission);
  impl->world = impl->mission.world;
  if (options.first.value() + options.count > impl->mission.robots.count || options.count == 0) {
    return fail(ErrorCode::kBadInput, fmt::format("--ids: the mission has robots 0 to {}",
                                                  impl->mission.robots.count - 1));
  }
  if (auto robots = impl->make_robots(run->seed); !robots) return tl::unexpected(robots.error());
  if (auto joined = impl->join(*run); !joined) return tl::unexpected(joined.error());
  return std::unique_ptr<AgentProcess>(new AgentProcess(std::move(impl)));
}

Result<void> AgentProcess::run() {
  Impl& p = *impl_;
  const Duration period = from_seconds(1.0 / p.mission.control.rate_hz);
  // Processes tick out of step with each other, so that they do not all want the CPU at once:
  // multiples of the golden ratio spread any number of them evenly over the period.
  const double turn = p.options.first.value() * (std::numbers::phi - 1.0);
  const Duration phase = from_seconds(to_seconds(period) * (turn - std::floor(turn)));
  const auto now = std::chrono::steady_clock::now();
  SteadyTime next = now - now.time_since_epoch() % period + period + phase;
  while (shell::stop_requests() == 0) {
    if (!sleep_until(next)) continue;
    const SteadyTime started = std::chrono::steady_clock::now();
    p.tick({.now = started, .utc_now = utc_now(), .lateness = started - next, .period = period});
    next += period;
    // After an overrun of whole periods the missed ticks are skipped, not replayed in a burst.
    const SteadyTime finished = std::chrono::steady_clock::now();
    if (finished > next) next += (finished - next) / period * period;
    if (p.options.parent_pid != 0 &&
        static_cast<std::uint32_t>(::getppid()) != p.options.parent_pid)
      break;
  }
  const UtcTime at_end = utc_now();
  p.record_link_stats(at_end);
  for (std::size_t first = 0; first < p.robots.size(); first += kStatusGroup) {
    p.tell_status(first, at_end);
  }
  for (Robot& robot : p.robots) robot.note(at_end, "exit", "graceful end");
  return {};
}

}  // namespace swarm::agent
