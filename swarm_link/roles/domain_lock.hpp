// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "swarmflow/core/result.hpp"

namespace swarm::link {

/// What a run needs of its DDS domain.
struct DomainNeeds {
  std::uint32_t participants = 1;  ///< at most; each has a pair of ports
  /// Number of those, from the first on, that must get exactly their ports, since others know them
  /// (fixed_participants()); the rest skip ports that are taken.
  std::uint32_t fixed = 0;
};

/// The machine as the lock finds it; tests replace it.
struct DomainHost {
  /// Prefix of the names of the locks: only locks with the same one see each other.
  std::string name = "swarmflow-domain-";
  /// Whether no other program has a UDP port. `shared`: whether it can be shared with those that
  /// have it, as all receivers of a multicast group do.
  std::function<bool(std::uint16_t port, bool shared)> is_free;
};

/// Reserves DDS domains on this machine for one run, so that two runs never receive each other and
/// never compete for ports. A run with many processes needs more than the 120 port pairs of its
/// domain and uses those of the next domains, which are reserved with it.
///
/// The reservation is an abstract Unix socket per domain. Unlike a file it has no owner, mode or
/// folder, so runs of all users see each other; it belongs to the network namespace, as the ports
/// do; and the kernel releases it with the process. Programs that know nothing of it, other DDS
/// applications, are found by their ports.
class DomainLock {
 public:
  /// `wanted` < 0: the first block that no other run has and whose ports are all free. A domain
  /// that the user asked for must only be free of other runs and have the ports that cannot be
  /// replaced. Fails when the wanted block is in use or none is free. Opens and closes a socket for
  /// each port that it looks at, about 10 µs.
  static Result<DomainLock> take(int wanted, const DomainNeeds& needs, DomainHost host = {});

  DomainLock(DomainLock&& other) noexcept;
  DomainLock& operator=(DomainLock&&) = delete;
  ~DomainLock();

  /// The first domain of the block: the one the run uses.
  std::uint32_t domain() const { return domain_; }

 private:
  DomainLock() = default;
  bool reserve(std::uint32_t block, const std::string& name);

  std::uint32_t domain_ = 0;
  std::vector<int> sockets_;  ///< of the block; closing releases the locks
};

}  // namespace swarm::link
