// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/live_source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_monitor/view/scene_json.hpp"
#include "swarm_monitor/view/view_frame.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::monitor {
namespace {

/// Period of the rows of the series.
constexpr Duration kRowEvery = std::chrono::seconds(1);

/// Metrics in Prometheus' text format: help, type and value of each.
class Metrics {
 public:
  template <class T>
  void add(const char* name, const char* type, const char* help, T value) {
    text_ += fmt::format("# HELP {0} {1}\n# TYPE {0} {2}\n{0} {3}\n", name, help, type, value);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace

Result<std::unique_ptr<LiveSource>> look_at_run(const std::filesystem::path& run_dir,
                                                std::uint32_t number, bool control) {
  auto mission = load_mission(run_dir / shell::kMissionFile, open_catalogue());
  if (!mission) return tl::unexpected(mission.error());
  const auto run = shell::read_run_info(run_dir);
  if (!run) return tl::unexpected(run.error());
  auto tap = tap_bus(run_dir, number);
  if (!tap) return tl::unexpected(tap.error());
  return std::make_unique<LiveSource>(std::move(*mission), *run, std::move(*tap), control);
}

LiveSource::LiveSource(Mission mission, const shell::RunInfo& run, std::unique_ptr<BusTap> tap,
                       bool control)
    : mission_(std::move(mission)),
      channel_(run.channel),
      control_(control),
      tap_(std::move(tap)),
      state_(mission_, stamps_of(run)),
      now_(utc_now()) {
  for (const RecordedTopic& topic : recorded_topics()) {
    raw_channels_.push_back({topic.name, topic.schema.name, topic.schema.data});
  }
  add_scene();
}

/// Drains the tap without waiting. Scene, events and series are brought up to date afterwards, once
/// per poll.
void LiveSource::poll(UtcTime now) {
  now_ = now;
  tap_->take(Duration(0), [this](const TappedSample& sample) {
    state_.take(sample);
    if (raw_sink_) {
      raw_sink_({.channel = sample.topic,
                 .stamp = sample.received,
                 .bytes = std::as_bytes(sample.bytes)});
    }
  });
  if (state_.version() != scene_version_ || state_.scene().moves(now)) add_scene();
  while (events_.size() < state_.events().size()) {
    events_.push_back(event_json(state_.events()[events_.size()]));
  }
  if (now - row_at_ >= kRowEvery && state_.begin()) add_row();
}

void LiveSource::add_scene() {
  // While an obstacle moves, the scene is sent again five times a second.
  constexpr Duration kMotion = std::chrono::milliseconds(200);
  const bool changed = scenes_.empty() || state_.version() != scene_version_;
  if (!changed && now_ - moved_at_ < kMotion) return;
  moved_at_ = now_;
  scene_version_ = state_.version();
  const World world = world_at(mission_.world, state_.scene(), now_);
  std::string scene =
      scene_json({.mission = mission_,
                  .world = world,
                  .goal = goal(),
                  .plan = state_.plan() ? &*state_.plan() : nullptr,
                  .plan_excess_m = state_.plan_excess_m(),
                  .from_s = state_.begin() ? to_seconds(now_ - *state_.begin()) : 0.0,
                  .live = true,
                  .control = control_,
                  .channel = channel_});
  scenes_.push_back(std::move(scene));
  // Viewers of a live run get the newest scene alone; earlier texts are cleared to bound the
  // memory.
  if (scenes_.size() > 1) scenes_[scenes_.size() - 2].clear();
}

const Mixture& LiveSource::goal() const {
  return state_.scene().goal ? *state_.scene().goal : mission_.goal;
}

/// One row per second: the latency is the 99 % quantile of the states since the last row, the rate
/// their number per second. The latency is undefined without states, the rate in the first row.
void LiveSource::add_row() {
  const double passed_s = to_seconds(now_ - row_at_);
  const SwarmState::Counts counts = state_.counts(now_);
  const std::uint64_t received = state_.meter().counts().received;
  Histogram latency = state_.meter().take_recent_latency();
  series_.push_back(series_json(
      {.time_s = to_seconds(now_ - *state_.begin()),
       .nearest_gap_m = counts.nearest_gap_m,
       .arrived = counts.arrived,
       .moving = counts.moving,
       .latency_ms = latency.count() > 0 ? 1e-3 * static_cast<double>(latency.quantile_us(0.99))
                                         : std::numeric_limits<double>::quiet_NaN(),
       .rate_hz = row_at_ == UtcTime{}
                      ? std::numeric_limits<double>::quiet_NaN()
                      : static_cast<double>(received - received_at_row_) / passed_s}));
  row_at_ = now_;
  received_at_row_ = received;
}

void LiveSource::view_frame(std::optional<double>, std::optional<RobotId> focus,
                            std::vector<std::byte>& out) {
  const auto& robots = state_.robots();
  std::optional<Mixture> mixture;
  if (state_.plan()) mixture = state_.plan()->mixture_at(MissionTime(state_.plan_time_s(now_)));
  ViewFrameEncoder maker(out, static_cast<std::uint32_t>(robots.size()),
                         state_.begin() ? to_seconds(now_ - *state_.begin()) : 0.0,
                         static_cast<std::uint32_t>(state_.phase()), mixture);
  maker.set_origin(origin_m());
  for (const SwarmState::Robot& robot : robots) {
    maker.add({.position_m = state_.position_of(robot, now_),
               .heading_rad = std::atan2(robot.velocity_mps.y(), robot.velocity_mps.x()),
               .mode = robot.mode,
               .neighbours = static_cast<std::uint8_t>(std::min(robot.neighbours, 255U)),
               .was_received = robot.was_received,
               .arrived = robot.arrived,
               .lost = state_.is_lost(robot, now_)});
  }
  // Robots' estimates are not published; the view shows the robots within the communication radius,
  // whose states the chosen robot must receive.
  std::vector<FrameEstimate> near;
  const bool known = focus && focus->value() < robots.size() && robots[focus->value()].was_received;
  if (known) {
    const Vec2 here = state_.position_of(robots[focus->value()], now_);
    for (std::uint32_t i = 0; i < robots.size(); ++i) {
      if (i == focus->value() || !robots[i].was_received) continue;
      const Vec2 there = state_.position_of(robots[i], now_);
      if ((there - here).norm() <= mission_.link.communication_radius_m)
        near.push_back({RobotId(i), there});
    }
  }
  maker.finish(known ? focus : std::nullopt, near);
}

/// Names are fixed, since dashboards use them; the help texts are for people.
std::string LiveSource::metrics() const {
  const SwarmState::Counts counts = state_.counts(now_);
  const link::StreamMeter::Counts& states = state_.meter().counts();
  const Histogram& latency = state_.meter().latency();
  Metrics m;
  m.add("swarm_robots", "gauge", "Robots of the mission.", state_.robots().size());
  m.add("swarm_robots_heard", "gauge", "Robots received at least once.", counts.received);
  m.add("swarm_robots_moving", "gauge", "Robots that move.", counts.moving);
  m.add("swarm_robots_arrived", "gauge", "Robots that have arrived.", counts.arrived);
  m.add("swarm_robots_lost", "gauge", "Robots not received for three seconds.", counts.lost);
  if (std::isfinite(counts.nearest_gap_m)) {
    m.add("swarm_nearest_gap_meters", "gauge", "Smallest gap that any robot reports.",
          counts.nearest_gap_m);
  }
  m.add("swarm_phase", "gauge", "0 ready, 1 running, 2 paused, 3 stopped.",
        static_cast<int>(state_.phase()));
  m.add("swarm_mission_seconds", "gauge", "Time of the mission.", state_.mission_time_s(now_));
  m.add("swarm_plan_seconds", "gauge", "Time of the plan's clock.", state_.plan_time_s(now_));
  m.add("swarm_plan_rate", "gauge", "Seconds of plan time per second.", state_.plan_rate());
  m.add("swarm_plan_version", "gauge", "Version of the plan.", state_.plan_version());
  m.add("swarm_plan_excess_metres", "gauge", "Largest constraint violation that a plan reported.",
        state_.plan_excess_m());
  m.add("swarm_states_received_total", "counter", "States received, each counted once.",
        states.received);
  m.add("swarm_states_lost_total", "counter", "States whose numbers were skipped.", states.lost);
  m.add("swarm_states_duplicate_total", "counter", "States received again.", states.duplicates);
  m.add("swarm_messages_refused_total", "counter", "Messages that were refused.",
        state_.refused().total());
  m.add("swarm_events_total", "counter", "Events received.", state_.events().size());
  std::string text = m.take();
  text +=
      "# HELP swarm_state_latency_seconds From writing to reception.\n"
      "# TYPE swarm_state_latency_seconds summary\n";
  for (const double q : {0.5, 0.99, 0.999}) {
    text += fmt::format("swarm_state_latency_seconds{{quantile=\"{}\"}} {}\n", q,
                        1e-6 * static_cast<double>(latency.quantile_us(q)));
  }
  text += fmt::format("swarm_state_latency_seconds_count {}\n", latency.count());
  return text;
}

}  // namespace swarm::monitor
