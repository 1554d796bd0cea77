// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/file_thread.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <ctime>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <semaphore.h>

#include "swarm_core/app/record_ring.hpp"

namespace swarm::shell {

namespace detail {

/// A file that is appended to. What has no other comment belongs to the thread.
struct Stream {
  Stream(files::AppendFormat format, Flush how, std::size_t capacity_bytes)
      : ring(capacity_bytes), file(std::move(format)), flush(how) {}

  RecordRing ring;
  files::AppendFile file;
  const Flush flush;
  std::atomic<std::uint64_t> dropped{0};
  std::atomic<int> last_error{0};
  std::atomic<bool> was_removed{false};
  int error = 0;
  SteadyTime retry_at{};
  Duration retry_after{};
};

/// Content of a file that waits to be written; null: it is to be removed.
using Content = std::shared_ptr<const std::string>;

struct FileThreadState {
  explicit FileThreadState(std::unique_ptr<files::Disk> d) : disk(std::move(d)) {
    ::sem_init(&work, 0, 0);
  }
  ~FileThreadState() { ::sem_destroy(&work); }
  FileThreadState(const FileThreadState&) = delete;
  FileThreadState& operator=(const FileThreadState&) = delete;

  void wake() {
    if (!is_awake.exchange(true)) ::sem_post(&work);
  }

  const std::unique_ptr<files::Disk> disk;
  sem_t work{};
  std::atomic<bool> is_awake{false};
  std::atomic<std::uint64_t> lost{0};
  std::atomic<std::uint32_t> removed{0};
  std::atomic<std::uint64_t> progress{0};        ///< writes that succeeded
  std::atomic<std::int64_t> busy_since_ns{0};    ///< begin of the present pass; 0: it waits
  std::atomic<bool> is_finishing{false};
  std::atomic<bool> is_abandoned{false};
  std::atomic<std::uint64_t> flushes_wanted{0};
  std::atomic<const Stream*> at{nullptr};        ///< the file that the thread writes

  mutable std::mutex mutex;  ///< of everything below; never held while the disk is asked
  std::condition_variable changed;
  std::deque<Stream> streams;
  std::map<std::filesystem::path, Content> waiting;  ///< whole files
  std::map<std::filesystem::path, Content> kept;
  std::map<std::filesystem::path, int> whole_errors;
  std::vector<std::filesystem::path> whole_lost;
  std::size_t waiting_bytes = 0;
  std::uint64_t flushes_done = 0;
  FileHealth health;
  bool has_ended = false;
  std::thread thread;
};

}  // namespace detail

namespace {

using detail::Content;
using detail::FileThreadState;
using detail::Stream;

constexpr std::size_t kBatchBytes = 8192;           // progress of a slow disk or reader is seen
constexpr std::size_t kMostWaitingBytes = 64U << 20U;
constexpr Duration kPeriod = std::chrono::seconds(1);
constexpr Duration kFirstRetry = std::chrono::milliseconds(100);
constexpr Duration kNoAnswer = std::chrono::seconds(1);
constexpr Duration kKeepEvery = std::chrono::seconds(2);

SteadyTime steady_now() { return std::chrono::steady_clock::now(); }

/// The body of the thread. It alone asks the disk.
class Worker {
 public:
  explicit Worker(FileThreadState& state) : s_(state), disk_(*state.disk) {}

  void run() {
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

 private:
  void wait() {
    const Duration period = fails_ || s_.is_finishing.load() ? kFirstRetry : kPeriod;
    const std::int64_t until_ns = (steady_now() + period).time_since_epoch().count();
    const timespec until{.tv_sec = static_cast<time_t>(until_ns / 1'000'000'000),
                         .tv_nsec = static_cast<long>(until_ns % 1'000'000'000)};
    while (::sem_clockwait(&s_.work, CLOCK_MONOTONIC, &until) != 0 && errno == EINTR) {
    }
    s_.is_awake.store(false);
  }

  /// Writes everything that waits. `at_once`: also what failed a moment ago. True if nothing is
  /// left.
  bool pass(bool at_once) {
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

  void append(Stream& stream, SteadyTime now) {
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

  void remake_missing() {
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

  void write_whole_files(SteadyTime now) {
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

  void report() {
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

  FileThreadState& s_;
  files::Disk& disk_;
  std::vector<Stream*> streams_;
  files::Bytes batch_;
  bool fails_ = false;
  std::uint64_t flushed_ = 0;
  SteadyTime keep_at_{};
  SteadyTime whole_retry_at_{};
  Duration whole_retry_after_{};
};

// Signals belong to the main thread, whose sleep they end.
void begin_thread(const std::shared_ptr<FileThreadState>& state) {
  sigset_t all;
  sigset_t before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  state->thread = std::thread([state] { Worker(*state).run(); });
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
    state.changed.wait_for(lock, std::min<Duration>(until - now, kFirstRetry));
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
  return wait_for(*state_, limit, [&] {
    return state_->flushes_done >= wanted || state_->has_ended;
  });
}

std::vector<FileLoss> FileThread::finish(Duration limit) {
  FileThreadState& s = *state_;
  if (s.thread.joinable()) {
    s.is_finishing.store(true);
    s.wake();
    const auto ended = [&s] { return s.has_ended; };
    if (!wait_for(s, limit, ended)) {
      // It ends at its next step, unless the disk does not answer: then it ends with the process.
      s.is_abandoned.store(true);
      s.wake();
      wait_for(s, kFirstRetry * 2, ended);
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
