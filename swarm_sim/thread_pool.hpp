// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <barrier>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace swarm::launcher {

/// A pool of threads in lock-step: run() gives each thread a part of the work and returns when all
/// parts are done. A barrier at the beginning and one at the end of each run() synchronise them.
class ThreadPool {
 public:
  /// `size` workers, the calling thread among them. \pre size ≥ 1
  explicit ThreadPool(std::size_t size) : gate_(static_cast<std::ptrdiff_t>(size)) {
    /// Part 0 is done by the calling thread.
    for (std::size_t part = 1; part < size; ++part) {
      others_.emplace_back([this, part] {
        for (;;) {
          gate_.arrive_and_wait();  // begin of a run(), or the end of the pool
          if (done_) return;
          (*work_)(part);
          gate_.arrive_and_wait();  // end of a run()
        }
      });
    }
  }
  /// Releases the workers from their wait, and joins them.
  ~ThreadPool() {
    done_ = true;
    gate_.arrive_and_wait();
    for (std::thread& other : others_) other.join();
  }
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// Number of parts, the calling thread's included.
  std::size_t size() const { return others_.size() + 1; }

  /// Calls work(0) … work(size() − 1), each on a thread of its own. It must not throw.
  void run(const std::function<void(std::size_t)>& work) {
    if (others_.empty()) return work(0);
    work_ = &work;
    gate_.arrive_and_wait();
    work(0);
    gate_.arrive_and_wait();
  }

 private:
  // Workers and caller meet here twice per run().
  std::barrier<> gate_;
  const std::function<void(std::size_t)>* work_ = nullptr;
  bool done_ = false;
  std::vector<std::thread> others_;
};

}  // namespace swarm::launcher
