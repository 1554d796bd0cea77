// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A wall clock that is set back does not make the threads of Cyclone DDS sleep.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <memory>
#include <thread>

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "swarm_link/adapters/cyclone/cyclone_participant.hpp"

namespace {

std::atomic<long> wall_offset_s = 0;

}  // namespace

// Of Cyclone DDS, whose headers are for its adapter alone.
extern "C" {
std::int32_t dds_create_participant(std::uint32_t domain, const void* qos, const void* listener);
std::int32_t dds_create_waitset(std::int32_t participant);
std::int32_t dds_create_guardcondition(std::int32_t participant);
std::int32_t dds_waitset_attach(std::int32_t set, std::int32_t condition, std::intptr_t tag);
std::int32_t dds_waitset_wait(std::int32_t set, std::intptr_t* tags, std::size_t most,
                              std::int64_t span_ns);
}

// Takes precedence over that of libc, as a clock that was set does.
extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const long result = ::syscall(SYS_clock_gettime, clock, time);
  if (clock == CLOCK_REALTIME) time->tv_sec += wall_offset_s;
  return static_cast<int>(result);
}

namespace swarm::link {
namespace {

constexpr std::uint32_t kDomain = 77;

TEST(CycloneWaits, EndInTimeAlsoWhenTheWallClockIsSetBack) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer has waits of its own";
#endif
  const auto participant = make_cyclone_participant({.name = "waits", .domain = kDomain});
  ASSERT_TRUE(participant) << participant.error().message;
  const auto has_ended = std::make_shared<std::atomic<bool>>(false);

  wall_offset_s = 3600;  // the library sets the end of its wait by this clock
  const std::int32_t own = dds_create_participant(kDomain, nullptr, nullptr);
  const std::int32_t set = dds_create_waitset(own);
  ASSERT_EQ(dds_waitset_attach(set, dds_create_guardcondition(own), 0), 0);
  std::thread([set, has_ended] {
    dds_waitset_wait(set, nullptr, 0, 200'000'000);
    *has_ended = true;
  }).detach();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  wall_offset_s = 0;

  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!*has_ended && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_TRUE(*has_ended) << "it sleeps until the wall clock has caught up";
}

}  // namespace
}  // namespace swarm::link
