// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "swarmflow/core/result.hpp"

namespace swarm::link {

/// Reserves DDS domains on this machine for one run, so that two runs never receive each other and
/// never compete for ports. A run with many processes needs more than the 120 port pairs of its
/// domain and uses those of the next domains, which are reserved with it. The reservation is a file
/// lock, which the kernel releases if the launcher crashes.
class DomainLock {
 public:
  /// `wanted` < 0: the first free block. Fails when the wanted block is in use or none is free.
  static Result<DomainLock> take(int wanted, std::uint32_t participants);

  DomainLock(DomainLock&& other) noexcept;
  DomainLock& operator=(DomainLock&&) = delete;
  ~DomainLock();

  /// The first domain of the block: the one the run uses.
  std::uint32_t domain() const { return domain_; }

 private:
  DomainLock() = default;
  std::uint32_t domain_ = 0;
  std::vector<int> files_;  ///< of the block; closing releases the locks
};

}  // namespace swarm::link
