// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/host_limits.hpp"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <sys/resource.h>

namespace swarm::launcher {
namespace {

// Measured: an agent of one robot has 54 open files, with the 5 m cells around it joined, and four
// threads. The limits include a reserve.
constexpr std::uint64_t kFilesAnAgent = 80;
constexpr std::uint64_t kFilesARobot = 1;  // its robot log
constexpr std::uint64_t kFilesARelay = 16;
constexpr std::uint64_t kThreadsAnAgent = 4;
constexpr std::uint64_t kThreadsOfOthers = 200;
/// With fewer processes, scheduling by session makes little difference.
constexpr std::uint32_t kManyAgents = 100;

std::uint64_t limit_of(__rlimit_resource resource) {
  rlimit limit{};
  return ::getrlimit(resource, &limit) == 0 ? limit.rlim_cur : RLIM_INFINITY;
}

}  // namespace

HostLimits read_host_limits() {
  int autogroup = 0;
  std::ifstream("/proc/sys/kernel/sched_autogroup_enabled") >> autogroup;
  return {.open_files = limit_of(RLIMIT_NOFILE),
          .threads = limit_of(RLIMIT_NPROC),
          .autogroup = autogroup == 1};
}

void raise_open_files() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  constexpr rlim_t kEnough = 65'536;  // some libraries iterate over all possible files
  limit.rlim_cur = std::max(limit.rlim_cur, std::min(limit.rlim_max, kEnough));
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

// Files are limited per process: the larger of an agent and the launcher counts. Threads are
// limited per user: all count.
std::vector<std::string> shortcomings(const HostLimits& limits, const RunSize& run) {
  std::vector<std::string> list;
  const std::uint64_t files = std::max(kFilesAnAgent + kFilesARobot * run.robots_per_process,
                                       kFilesAnAgent + kFilesARelay * run.relays);
  if (limits.open_files < files) {
    list.push_back(
        fmt::format("a process may open {} files and needs about {}: run 'ulimit -n {}' before",
                    limits.open_files, files, 2 * files));
  }
  const std::uint64_t threads = kThreadsAnAgent * run.agents + kThreadsOfOthers;
  if (limits.threads < threads) {
    list.push_back(fmt::format(
        "this user may have {} threads and the run needs about {}: run 'ulimit -u {}' before, or "
        "host several robots in a process (--per-process)",
        limits.threads, threads, 2 * threads));
  }
  if (limits.autogroup && run.agents > kManyAgents) {
    list.emplace_back(
        "the kernel shares out the CPU by session first, whatever the priorities: another "
        "session's "
        "load takes as much as all robots together. If ticks are late, run 'sysctl -w "
        "kernel.sched_autogroup_enabled=0' as root");
  }
  return list;
}

}  // namespace swarm::launcher
