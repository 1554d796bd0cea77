// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <poll.h>

namespace swarm::link {

/// Many sockets, few of which hold datagrams: one system call finds these. Not thread-safe.
class SocketSet {
 public:
  void add(int fd);
  void remove(int fd);

  /// The sockets that hold datagrams now. Valid until the next call of this object. Never waits,
  /// and allocates nothing.
  std::span<const int> waiting();
  /// All sockets, in the order in which they were added.
  std::span<const int> all() const { return all_; }

 private:
  std::vector<int> all_;
  std::vector<pollfd> polled_;  // of these, in the same order
  std::vector<int> waiting_;
};

}  // namespace swarm::link
