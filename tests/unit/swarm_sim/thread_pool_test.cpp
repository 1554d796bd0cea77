// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_sim/thread_pool.hpp"

#include <atomic>
#include <numeric>
#include <set>
#include <thread>

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

TEST(ThreadPool, DoesEveryPartOnceInEachRun) {
  for (const std::size_t size : {1U, 2U, 5U}) {
    ThreadPool pool(size);
    ASSERT_EQ(pool.size(), size);
    std::vector<int> done(size, 0);
    for (int run = 1; run <= 200; ++run) {
      pool.run([&](std::size_t part) { ++done[part]; });
      ASSERT_EQ(done, std::vector<int>(size, run)) << "all parts are done when run() returns";
    }
  }
}

TEST(ThreadPool, GivesEachPartAThreadOfItsOwnAndTheFirstToTheCaller) {
  ThreadPool pool(4);
  std::vector<std::thread::id> first(4);
  std::vector<std::thread::id> second(4);

  pool.run([&](std::size_t part) { first[part] = std::this_thread::get_id(); });
  pool.run([&](std::size_t part) { second[part] = std::this_thread::get_id(); });

  EXPECT_EQ(first[0], std::this_thread::get_id());
  EXPECT_EQ(std::set(first.begin(), first.end()).size(), 4U);
  EXPECT_EQ(second, first);
}

TEST(ThreadPool, RunsItsPartsAtTheSameTime) {
  // Each part waits until all have begun: it would never end if one thread did two of them.
  ThreadPool pool(3);
  for (int run = 0; run < 20; ++run) {
    std::atomic<int> begun = 0;
    pool.run([&](std::size_t) {
      ++begun;
      while (begun < 3) std::this_thread::yield();
    });
    EXPECT_EQ(begun, 3);
  }
}

TEST(ThreadPool, ShowsEachRunWhatAllPartsWroteInTheRunBefore) {
  // Each part adds up what all parts wrote, without a lock: run() orders memory.
  constexpr std::size_t kSize = 4;
  ThreadPool pool(kSize);
  std::vector<long> now(kSize, 1);
  std::vector<long> next(kSize, 0);
  for (int run = 0; run < 20; ++run) {
    pool.run([&](std::size_t part) { next[part] = std::accumulate(now.begin(), now.end(), 0L); });
    std::swap(now, next);
  }
  long expected = 1;
  for (int run = 0; run < 20; ++run) expected *= static_cast<long>(kSize);
  EXPECT_EQ(now, std::vector<long>(kSize, expected));
}

TEST(ThreadPool, EndsWithoutARun) {
  for (int i = 0; i < 50; ++i) ThreadPool pool(3);
}

TEST(ThreadPool, IsNotMixedUpWithAnother) {
  ThreadPool one(2);
  ThreadPool other(3);
  std::atomic<int> of_one = 0;
  std::atomic<int> of_other = 0;
  for (int run = 0; run < 50; ++run) {
    one.run([&](std::size_t) { ++of_one; });
    other.run([&](std::size_t) { ++of_other; });
  }
  EXPECT_EQ(of_one, 100);
  EXPECT_EQ(of_other, 150);
}

}  // namespace
}  // namespace swarm::launcher
