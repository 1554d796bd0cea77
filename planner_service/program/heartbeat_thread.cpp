// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/program/heartbeat_thread.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <utility>

#include "swarm_core/base/clock.hpp"

namespace swarm::planner {

// Stop signals are for the planner's loop, which sleeps: the thread starts with them blocked.
HeartbeatThread::HeartbeatThread(link::WriterPtr<link::HeartbeatMessage> writer,
                                 const HeartbeatSource& source, Duration period)
    : writer_(std::move(writer)), source_(source), period_(period) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, &before);
  thread_ = std::thread([this] { run(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

HeartbeatThread::~HeartbeatThread() {
  {
    const std::scoped_lock lock(mutex_);
    is_ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void HeartbeatThread::on_step(const PlannerState& state) {
  const std::scoped_lock lock(mutex_);
  source_.on_step(state);
}

void HeartbeatThread::pause() {
  const std::scoped_lock lock(mutex_);
  source_.pause();
}

void HeartbeatThread::begin_epoch(PlannerEpoch epoch) {
  const std::scoped_lock lock(mutex_);
  source_.begin_epoch(epoch);
}

void HeartbeatThread::beat() {
  const std::scoped_lock lock(mutex_);
  beat_locked();
}

PlanClock HeartbeatThread::published() const {
  const std::scoped_lock lock(mutex_);
  return source_.published();
}

// Written under the lock: numbers reach the bus in their order.
void HeartbeatThread::beat_locked() {
  if (const auto beat = source_.next(std::chrono::steady_clock::now(), utc_now())) {
    writer_->write(*beat);
  }
}

// A thread that woke up late does not catch up on what it missed.
void HeartbeatThread::run() {
  std::unique_lock lock(mutex_);
  SteadyTime next = std::chrono::steady_clock::now();
  while (!is_ending_) {
    beat_locked();
    next = std::max(next + period_, SteadyTime(std::chrono::steady_clock::now()));
    wake_.wait_until(lock, next, [this] { return is_ending_; });
  }
}

}  // namespace swarm::planner
