// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/fastdds/cached_thread_id.hpp"

#include <cstdarg>

#include <dlfcn.h>
#include <sys/syscall.h>

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

extern "C" long syscall(long number, ...) noexcept {
  static const auto real = reinterpret_cast<long (*)(long, ...)>(::dlsym(RTLD_NEXT, "syscall"));
  if (number == SYS_gettid) {
    // A child after fork() would get its parent's cached id; our children only call exec.
    thread_local const long id = real(SYS_gettid);
    return id;
  }
  std::va_list arguments;
  va_start(arguments, number);
  long a[6];
  for (long& argument : a)
    argument = va_arg(arguments, long);  // no system call takes more than six
  va_end(arguments);
  return real(number, a[0], a[1], a[2], a[3], a[4], a[5]);
}

#endif

namespace swarm::link::fastdds {

void cache_thread_ids() {}

}  // namespace swarm::link::fastdds
