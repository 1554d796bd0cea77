// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/soak/process_sample.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

namespace swarm::launcher {
namespace {

/// Fields of /proc/PID/stat behind the name in brackets, which may hold anything.
std::istringstream fields_of(const std::string& stat) {
  const std::size_t end = stat.rfind(')');
  return std::istringstream(end == std::string::npos ? "" : stat.substr(end + 1));
}

}  // namespace

/// Field numbers are those of proc(5): 14 and 15 CPU ticks, 20 threads, 24 resident pages. A
/// process that ends in between gives an incomplete file, hence an empty result.
std::optional<ProcessSample> sample_process(pid_t pid) {
  const std::string folder = fmt::format("/proc/{}", pid);
  std::string stat;
  std::getline(std::ifstream(folder + "/stat"), stat);
  std::istringstream fields = fields_of(stat);
  std::string skipped;
  for (int i = 3; i < 14; ++i) fields >> skipped;  // numbered as in proc(5)
  double user_ticks = 0.0, system_ticks = 0.0, rss_pages = 0.0;
  ProcessSample sample;
  fields >> user_ticks >> system_ticks;
  for (int i = 16; i < 20; ++i) fields >> skipped;
  fields >> sample.threads;
  for (int i = 21; i < 24; ++i) fields >> skipped;
  fields >> rss_pages;
  if (!fields) return std::nullopt;
  sample.cpu_s = (user_ticks + system_ticks) / static_cast<double>(::sysconf(_SC_CLK_TCK));
  sample.rss_mb = rss_pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);

  std::error_code gone;
  for (std::filesystem::directory_iterator files(folder + "/fd", gone), end; !gone && files != end;
       files.increment(gone)) {
    ++sample.open_files;
  }
  std::ifstream status(folder + "/status");
  for (std::string line; std::getline(status, line);) {
    const std::size_t colon = line.find("ctxt_switches:");
    if (colon == std::string::npos) continue;
    sample.context_switches += std::stoull(line.substr(colon + sizeof "ctxt_switches:" - 1));
  }
  return sample;
}

/// The counter RcvbufErrors of all sockets of the machine; there is none per process.
std::uint64_t udp_receive_drops() {
  // Two lines begin with "Udp:": the names, then the numbers.
  std::ifstream file("/proc/net/snmp");
  std::string line, names;
  while (std::getline(file, line)) {
    if (line.rfind("Udp:", 0) != 0) continue;
    if (names.empty()) {
      names = line;
      continue;
    }
    std::istringstream keys(names), values(line);
    for (std::string key, value; keys >> key && values >> value;) {
      if (key == "RcvbufErrors") return std::stoull(value);
    }
  }
  return 0;
}

}  // namespace swarm::launcher
