// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <barrier>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace swarm::launcher {

/// Threads that work in step: run() hands each a part of the work and returns when all are done.
class ThreadPool {
 public:
  /// `size` workers, the calling thread among them. \pre size ≥ 1
  explicit ThreadPool(std::size_t size) : gate_(static_cast<std::ptrdiff_t>(size)) {
    for (std::size_t part = 1; part < size; ++part) {
      others_.emplace_back([this, part] {
        for (;;) {
          gate_.arrive_and_wait();  // work is there
          if (done_) return;
          (*work_)(part);
          gate_.arrive_and_wait();  // work is done
        }
      });
    }
  }
  ~ThreadPool() {
    done_ = true;
    gate_.arrive_and_wait();
    for (std::thread& other : others_) other.join();
  }
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

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
  std::barrier<> gate_;
  const std::function<void(std::size_t)>* work_ = nullptr;
  bool done_ = false;
  std::vector<std::thread> others_;
};

}  // namespace swarm::launcher
