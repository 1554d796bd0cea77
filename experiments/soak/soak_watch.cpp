// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/soak/soak_watch.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "experiments/soak/process_sample.hpp"
#include "swarm_core/base/clock.hpp"

namespace swarm::launcher {
namespace {

constexpr Duration kSampleEvery = std::chrono::seconds(1);
constexpr Duration kListenFor =
    std::chrono::milliseconds(100);  // longest wait before the thread checks whether to end

}  // namespace

SoakWatch::SoakWatch(std::uint32_t robots) : robots_(robots), meter_(robots) {}

SoakWatch::~SoakWatch() {
  ended_ = true;
  if (listener_.joinable()) listener_.join();
}

void SoakWatch::listen(std::unique_ptr<link::GroupTap> tap) {
  tap_ = std::move(tap);
  listener_ = std::thread([this] { receive_all(); });
}

/// The thread of the listener. States count while the mission runs only; a batch gets one time of
/// reception, taken before the lock.
void SoakWatch::receive_all() {
  std::vector<link::CellStatesMessage> batches;
  while (!ended_) {
    batches.clear();
    if (tap_->take(kListenFor, batches) == 0 || !running_) continue;
    const UtcTime at = utc_now();
    const std::lock_guard lock(mutex_);
    for (const link::CellStatesMessage& batch : batches) {
      for (const link::RobotStateMessage& state : batch.states) meter_.receive(state, at);
    }
  }
}

/// Keeps the first and the newest counters of each robot: their difference is the count of the
/// soak. A robot whose process was restarted begins anew.
void SoakWatch::on_status(const link::StatusMessage& status) {
  if (!running_) return;
  paths_.on_status(status, utc_now());
  for (const link::RobotStatusMessage& now : status.robots) {
    Robot& robot = robots_[now.robot_id];
    if (robot.process_id != status.process_id) {
      robot = {.process_id = status.process_id, .first = now};
    }
    robot.last = now;
  }
  if (!status.state_age.empty()) ages_[status.process_id] = status.state_age;
}

void SoakWatch::on_heartbeat(SteadyTime now) {
  if (running_) paths_.on_heartbeat(now);
}

/// Called by the flight at every step: marks begin and end of the measurement, and takes a sample
/// when one is due.
void SoakWatch::on_step(const FlightLoop& flight, SteadyTime now) {
  const bool running = flight.supervisor().stage() == Supervisor::Stage::kRunning;
  if (running && !running_) {
    drops_before_ = udp_receive_drops();
    running_ = true;
  } else if (!running) {
    running_ = false;
    return;
  }
  if (now - sampled_at_ >= kSampleEvery) sample(flight, now);
}

/// Rates are differences to the last sample. CPU counts all processes of the run, memory and
/// threads the agents alone.
void SoakWatch::sample(const FlightLoop& flight, SteadyTime now) {
  SoakSample s{.time_s = flight.supervisor().mission_time(now).count()};
  double cpu_s = 0.0;
  std::uint64_t switches = 0;
  if (const auto own = sample_process(::getpid())) cpu_s += own->cpu_s;
  for (const auto& [pid, process] : flight.children()) {
    const auto one = sample_process(pid);
    if (!one) continue;
    cpu_s += one->cpu_s;
    // The planner counts as CPU only: it holds no robots.
    if (process == kPlanner) continue;
    s.rss_mb += one->rss_mb;
    s.rss_max_mb = std::max(s.rss_max_mb, one->rss_mb);
    s.threads += one->threads;
    s.open_files += one->open_files;
    switches += one->context_switches;
  }
  Histogram recent;
  std::uint64_t received = 0;
  {
    const std::lock_guard lock(mutex_);
    recent = meter_.take_recent_latency();
    received = meter_.counts().received;
  }
  const double passed_s = to_seconds(now - sampled_at_);
  s.p99_ms = 1e-3 * static_cast<double>(recent.quantile_us(0.99));
  s.cpu_share = std::max(0.0, cpu_s - cpu_s_) / passed_s;
  s.switches_hz = static_cast<double>(switches - std::min(switches, switches_)) / passed_s;
  s.received_hz = static_cast<double>(received - received_) / passed_s;
  // The rates of the first sample would be those since the processes began.
  if (cpu_s_ > 0.0) samples_.push_back(s);
  cpu_s_ = cpu_s;
  switches_ = switches;
  received_ = received;
  sampled_at_ = now;
  drops_ = udp_receive_drops() - drops_before_;
}

std::string SoakWatch::describe() {
  if (samples_.empty()) return {};
  const SoakSample& s = samples_.back();
  return fmt::format("p99 {:.1f} ms  cpu {:.0f} %  rss {:.0f} MB", s.p99_ms, 100.0 * s.cpu_share,
                     s.rss_mb);
}

SoakMeasurements SoakWatch::measurements() const {
  SoakMeasurements m{.samples = samples_, .paths = paths_.latencies(), .receive_drops = drops_};
  for (const Robot& robot : robots_) {
    const link::RobotStatusMessage &first = robot.first, &last = robot.last;
    m.states_sent += last.states_sent - first.states_sent;
    m.states_used += last.states_received - first.states_received;
    m.ticks += last.ticks - first.ticks;
    m.late_ticks += last.late_ticks - first.late_ticks;
  }
  // Each status carries the whole histogram of its process so far, so that the newest ones are
  // added.
  for (const auto& [process, bins] : ages_) {
    for (const link::HistogramBinMessage& bin : bins) m.use_latency.add_bin(bin.bin, bin.count);
  }
  const std::lock_guard lock(mutex_);
  if (tap_) m.received = meter_.counts();
  m.latency = meter_.latency();
  m.worst = meter_.worst();
  return m;
}

}  // namespace swarm::launcher
