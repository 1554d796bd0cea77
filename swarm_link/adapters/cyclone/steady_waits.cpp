// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/cyclone/steady_waits.hpp"

#include <algorithm>
#include <cstdint>

#include <dds/dds.h>
#include <dlfcn.h>
#include <pthread.h>
#include <time.h>

// The sanitizers have a pthread_cond_timedwait() of their own.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kLongest_s = 1'000'000'000;  // longer waits are for ever

std::int64_t to_ns(const timespec& time) {
  return std::clamp<std::int64_t>(time.tv_sec, -kLongest_s, 4 * kLongest_s) * kSecond_ns +
         time.tv_nsec;
}

std::int64_t now_ns(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return to_ns(now);
}

/// Where the library that contains this address is loaded; null if it is in none.
const void* library_of(const void* address) {
  Dl_info info{};
  return ::dladdr(address, &info) != 0 ? info.dli_fbase : nullptr;
}

bool is_of_cyclone(const void* caller) {
  static const void* const kCyclone =
      library_of(reinterpret_cast<const void*>(&dds_create_participant));
  return kCyclone != nullptr && library_of(caller) == kCyclone;
}

}  // namespace

extern "C" int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex,
                                      const timespec* until) {
  using Wait = int (*)(pthread_cond_t*, pthread_mutex_t*, const timespec*);
  static const auto real = reinterpret_cast<Wait>(::dlsym(RTLD_NEXT, "pthread_cond_timedwait"));
  if (!is_of_cyclone(__builtin_return_address(0))) return real(condition, mutex, until);
  const std::int64_t left_ns =
      std::clamp<std::int64_t>(to_ns(*until) - now_ns(CLOCK_REALTIME), 0, kLongest_s * kSecond_ns);
  const std::int64_t steady_ns = now_ns(CLOCK_MONOTONIC) + left_ns;
  const timespec steady{.tv_sec = steady_ns / kSecond_ns, .tv_nsec = steady_ns % kSecond_ns};
  return ::pthread_cond_clockwait(condition, mutex, CLOCK_MONOTONIC, &steady);
}

#endif

namespace swarm::link::cyclone {

void wait_by_steady_clock() {}

}  // namespace swarm::link::cyclone
