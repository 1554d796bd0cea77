// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/file_worker.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <ctime>
#include <filesystem>
#include <map>
#include <mutex>

#include <pthread.h>
#include <sched.h>
#include <semaphore.h>

namespace swarm::shell::detail {
namespace {

constexpr std::size_t kBatchBytes = 8192;  // progress of a slow disk or reader is seen
constexpr Duration kPeriod = std::chrono::seconds(1);
constexpr Duration kFirstRetry = std::chrono::milliseconds(100);
constexpr Duration kKeepEvery = std::chrono::seconds(2);

SteadyTime steady_now() { return std::chrono::steady_clock::now(); }

}  // namespace

// As a batch thread it preempts no tick when it is woken.
void FileWorker::run() {
  const sched_param none{};
  ::pthread_setschedparam(::pthread_self(), SCHED_BATCH, &none);
  while (true) {
    wait();
    const std::uint64_t wanted = s_.flushes_wanted.load();
    const bool finishing = s_.is_finishing.load();
    const bool all = pass(finishing || wanted > flushed_);
    if (all) flushed_ = wanted;
    report();
    if ((finishing && all) || s_.is_abandoned.load()) break;
  }
  if (!s_.is_abandoned.load()) {
    for (Stream* stream : streams_) stream->file.finish(disk_);
  }
  const std::lock_guard lock(s_.mutex);
  s_.has_ended = true;
  s_.changed.notify_all();
}

void FileWorker::wait() {
  const Duration period = fails_ || s_.is_finishing.load() ? kFirstRetry : kPeriod;
  const std::int64_t until_ns = (steady_now() + period).time_since_epoch().count();
  const timespec until{.tv_sec = static_cast<time_t>(until_ns / 1'000'000'000),
                       .tv_nsec = static_cast<long>(until_ns % 1'000'000'000)};
  while (::sem_clockwait(&s_.work, CLOCK_MONOTONIC, &until) != 0 && errno == EINTR) {
  }
  s_.is_awake.store(false);
}

bool FileWorker::pass(bool at_once) {
  const SteadyTime now = steady_now();
  s_.busy_since_ns.store(now.time_since_epoch().count());
  {
    const std::lock_guard lock(s_.mutex);
    for (std::size_t i = streams_.size(); i < s_.streams.size(); ++i) {
      streams_.push_back(&s_.streams[i]);
    }
  }
  bool all = true;
  fails_ = false;
  for (Stream* stream : streams_) {
    if (!stream->ring.is_empty() && (at_once || now >= stream->retry_at)) append(*stream, now);
    all = all && stream->ring.is_empty();
    fails_ = fails_ || stream->error != 0;
  }
  if (now >= keep_at_) {
    remake_missing();
    keep_at_ = now + kKeepEvery;
  }
  if (at_once || now >= whole_retry_at_) write_whole_files(now);
  s_.busy_since_ns.store(0);
  const std::lock_guard lock(s_.mutex);
  fails_ = fails_ || !s_.waiting.empty();
  return all && s_.waiting.empty();
}

void FileWorker::append(Stream& stream, SteadyTime now) {
  s_.at.store(&stream);
  stream.error = 0;
  while (!stream.ring.is_empty() && !s_.is_abandoned.load()) {
    batch_.clear();
    const RecordRing::Taken taken = stream.ring.copy(batch_, kBatchBytes);
    if (taken.records > 0) stream.error = stream.file.append(disk_, batch_);
    if (stream.error != 0) break;
    stream.ring.pop(taken);
    s_.progress.fetch_add(1);
    stream.retry_after = {};
  }
  if (stream.error != 0) {
    stream.last_error.store(stream.error);
    stream.retry_after = std::clamp(2 * stream.retry_after, kFirstRetry, kPeriod);
    stream.retry_at = now + stream.retry_after;
  }
  if (stream.file.times_removed() > 0 && !stream.was_removed.exchange(true)) {
    s_.removed.fetch_add(1);
    keep_at_ = {};  // others may have been removed with it
  }
  s_.at.store(nullptr);
}

void FileWorker::remake_missing() {
  std::map<std::filesystem::path, Content> kept;
  {
    const std::lock_guard lock(s_.mutex);
    if (s_.kept.empty()) return;
    kept = s_.kept;
  }
  for (const auto& [file, content] : kept) {
    if (disk_.exists(file)) continue;
    const std::lock_guard lock(s_.mutex);
    if (s_.waiting.emplace(file, content).second) s_.waiting_bytes += content->size();
  }
}

void FileWorker::write_whole_files(SteadyTime now) {
  std::map<std::filesystem::path, Content> waiting;
  {
    const std::lock_guard lock(s_.mutex);
    if (s_.waiting.empty()) return;
    waiting = s_.waiting;
  }
  whole_retry_after_ = std::clamp(2 * whole_retry_after_, kFirstRetry, kPeriod);
  whole_retry_at_ = now + whole_retry_after_;
  for (const auto& [file, content] : waiting) {
    if (s_.is_abandoned.load()) return;
    const int error = content ? disk_.replace(file, *content) : disk_.remove(file);
    const std::lock_guard lock(s_.mutex);
    if (error != 0) {
      s_.whole_errors[file] = error;
      continue;
    }
    s_.progress.fetch_add(1);
    s_.whole_errors.erase(file);
    const auto still = s_.waiting.find(file);
    if (still == s_.waiting.end() || still->second != content) continue;  // a newer one waits
    if (content) s_.waiting_bytes -= content->size();
    s_.waiting.erase(still);
  }
  const std::lock_guard lock(s_.mutex);
  if (s_.waiting.empty()) {
    whole_retry_after_ = {};
    whole_retry_at_ = {};
  }
}

void FileWorker::report() {
  const std::lock_guard lock(s_.mutex);
  FileHealth& health = s_.health;
  health.first.clear();
  health.failing = s_.whole_errors.size();
  health.error = s_.whole_errors.empty() ? 0 : s_.whole_errors.begin()->second;
  if (!s_.whole_errors.empty()) health.first = s_.whole_errors.begin()->first;
  for (const Stream* stream : streams_) {
    if (stream->error == 0) continue;
    if (health.failing++ == 0) {
      health.first = stream->file.file();
      health.error = stream->error;
    }
  }
  s_.flushes_done = flushed_;
  s_.changed.notify_all();
}

}  // namespace swarm::shell::detail
