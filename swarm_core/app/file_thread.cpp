// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/file_thread.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/app/file_thread_state.hpp"
#include "swarm_core/app/file_worker.hpp"

namespace swarm::shell {
namespace {

using detail::Content;
using detail::FileThreadState;
using detail::Stream;

constexpr std::size_t kMostWaitingBytes = 64U << 20U;
constexpr int kRefusedShare = 4;
constexpr Duration kLookEvery = std::chrono::milliseconds(100);
constexpr Duration kNoAnswer = std::chrono::seconds(1);

SteadyTime steady_now() { return std::chrono::steady_clock::now(); }

// Signals belong to the main thread, whose sleep they end.
void begin_thread(const std::shared_ptr<FileThreadState>& state) {
  sigset_t all;
  sigset_t before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  state->thread = std::thread([state] { detail::FileWorker(*state).run(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

/// Waits for a condition, for as long as there is progress and `limit` without. False at its end.
template <class Condition>
bool wait_for(FileThreadState& state, Duration limit, Condition condition) {
  std::unique_lock lock(state.mutex);
  std::uint64_t progress = state.progress.load();
  SteadyTime until = steady_now() + limit;
  while (!condition()) {
    const SteadyTime now = steady_now();
    if (const std::uint64_t newest = state.progress.load(); newest != progress) {
      progress = newest;
      until = now + limit;
    }
    if (now >= until) return false;
    state.changed.wait_for(lock, std::min<Duration>(until - now, kLookEvery));
  }
  return true;
}

}  // namespace

std::string describe(const FileLoss& loss) {
  std::string text = loss.file.filename().string() + ": ";
  if (loss.records > 0) {
    text += fmt::format("{} record{}", loss.records, loss.records == 1 ? "" : "s");
  } else {
    text += loss.was_removed ? "what it held before it was removed" : "all of it";
  }
  if (loss.records > 0 && loss.was_removed) text += " and what it held before it was removed";
  if (loss.error != 0) text += fmt::format(" ({})", std::strerror(loss.error));
  return text;
}

bool AppendStream::push(std::span<const unsigned char> block, std::uint32_t records) {
  const bool fits = stream_->ring.push(block, records);
  if (!fits) {
    stream_->dropped.fetch_add(records, std::memory_order_relaxed);
    state_->lost.fetch_add(records, std::memory_order_relaxed);
  }
  if (stream_->flush == Flush::kAtOnce) state_->wake();
  return fits;
}

bool AppendStream::push(std::string_view line) {
  return push({reinterpret_cast<const unsigned char*>(line.data()), line.size()});
}

std::uint64_t AppendStream::dropped() const {
  return stream_->dropped.load(std::memory_order_relaxed);
}

FileThread::FileThread() : FileThread(std::make_unique<files::RealDisk>()) {}

FileThread::FileThread(std::unique_ptr<files::Disk> disk)
    : state_(std::make_shared<FileThreadState>(std::move(disk))) {
  begin_thread(state_);
}

FileThread::~FileThread() { finish(); }

AppendStream FileThread::append_to(files::AppendFormat format, Flush flush,
                                   std::size_t capacity_bytes) {
  const std::lock_guard lock(state_->mutex);
  state_->streams.emplace_back(std::move(format), flush, capacity_bytes);
  return {state_, state_->streams.back()};
}

void FileThread::replace(const std::filesystem::path& file, std::string content) {
  auto shared = std::make_shared<const std::string>(std::move(content));
  {
    const std::lock_guard lock(state_->mutex);
    Content& waiting = state_->waiting[file];
    const std::size_t before = waiting ? waiting->size() : 0;
    if (state_->waiting_bytes - before + shared->size() > kMostWaitingBytes) {
      if (!waiting) state_->waiting.erase(file);
      state_->whole_lost.push_back(file);
      state_->lost.fetch_add(1);
      return;
    }
    state_->waiting_bytes += shared->size() - before;
    waiting = std::move(shared);
  }
  state_->wake();
}

void FileThread::keep(const std::filesystem::path& file, std::string content) {
  auto shared = std::make_shared<const std::string>(content);
  {
    const std::lock_guard lock(state_->mutex);
    state_->kept[file] = std::move(shared);
  }
  replace(file, std::move(content));
}

void FileThread::remove(const std::filesystem::path& file) {
  {
    const std::lock_guard lock(state_->mutex);
    Content& waiting = state_->waiting[file];
    if (waiting) state_->waiting_bytes -= waiting->size();
    waiting = nullptr;
    state_->kept.erase(file);
  }
  state_->wake();
}

FileHealth FileThread::health(SteadyTime now) const {
  const FileThreadState& s = *state_;
  const std::lock_guard lock(s.mutex);
  FileHealth health = s.health;
  health.lost = s.lost.load();
  health.removed = s.removed.load();
  const std::int64_t since_ns = s.busy_since_ns.load();
  if (health.failing == 0 && since_ns != 0 && now - SteadyTime(Duration(since_ns)) > kNoAnswer) {
    health.failing = 1;
    health.error = 0;
    if (const Stream* at = s.at.load()) health.first = at->file.file();
  }
  return health;
}

bool FileThread::flush(Duration limit) {
  const std::uint64_t wanted = state_->flushes_wanted.fetch_add(1) + 1;
  state_->wake();
  return wait_for(*state_, limit,
                  [&] { return state_->flushes_done >= wanted || state_->has_ended; });
}

std::vector<FileLoss> FileThread::finish(Duration limit) {
  FileThreadState& s = *state_;
  if (s.thread.joinable()) {
    s.is_finishing.store(true);
    s.wake();
    const auto ended = [&s] { return s.has_ended; };
    const auto ended_or_refused = [&s] {
      return s.has_ended || (s.busy_since_ns.load() == 0 && s.health.failing > 0);
    };
    // A disk that refuses is not waited for as long as one that is slow.
    if (!wait_for(s, limit, ended_or_refused) || !wait_for(s, limit / kRefusedShare, ended)) {
      // It ends at its next step, unless the disk does not answer: then it ends with the process.
      s.is_abandoned.store(true);
      s.wake();
      wait_for(s, kLookEvery * 2, ended);
    }
    std::unique_lock lock(s.mutex);
    const bool has_ended = s.has_ended;
    lock.unlock();
    if (has_ended) {
      s.thread.join();
    } else {
      s.thread.detach();
    }
  }
  std::vector<FileLoss> losses;
  const std::lock_guard lock(s.mutex);
  for (const Stream& stream : s.streams) {
    const std::uint64_t records = stream.dropped.load() + stream.ring.waiting();
    if (records == 0 && !stream.was_removed.load()) continue;
    losses.push_back({.file = stream.file.file(),
                      .records = records,
                      .error = stream.last_error.load(),
                      .was_removed = stream.was_removed.load()});
  }
  const auto error_of = [&s](const std::filesystem::path& file) {
    const auto known = s.whole_errors.find(file);
    return known == s.whole_errors.end() ? 0 : known->second;
  };
  for (const auto& [file, content] : s.waiting) {
    if (content) losses.push_back({.file = file, .error = error_of(file)});
  }
  for (const auto& file : s.whole_lost) losses.push_back({.file = file});
  return losses;
}

}  // namespace swarm::shell
