// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <sys/types.h>

namespace swarm::test {

/// UDP ports at which a process receives, but for those of multicast groups: what anybody on the
/// machine can find out.
inline std::vector<std::uint16_t> udp_ports_of(pid_t process) {
  const std::filesystem::path proc = "/proc/" + std::to_string(process);
  std::set<std::string> sockets;  // "socket:[inode]"
  std::error_code gone;
  for (const auto& file : std::filesystem::directory_iterator(proc / "fd", gone)) {
    sockets.insert(std::filesystem::read_symlink(file.path(), gone).string());
  }
  std::vector<std::uint16_t> ports;
  std::ifstream table(proc / "net" / "udp");
  std::string line;
  std::getline(table, line);  // the heading
  while (std::getline(table, line)) {
    std::istringstream fields(line);
    std::string number, local, remote, state, queues, timer, retries, user, timeout, inode;
    fields >> number >> local >> remote >> state >> queues >> timer >> retries >> user >> timeout >>
        inode;
    // The address is in hexadecimal digits, its first byte last: "0100007F:1CF2".
    if (local.size() != 13 || !sockets.contains("socket:[" + inode + "]")) continue;
    const bool is_multicast = std::stoul(local.substr(6, 2), nullptr, 16) >= 224;
    if (!is_multicast) {
      ports.push_back(static_cast<std::uint16_t>(std::stoul(local.substr(9), nullptr, 16)));
    }
  }
  return ports;
}

}  // namespace swarm::test
