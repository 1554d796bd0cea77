// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "swarmflow/core/result.hpp"

namespace swarm::link {

/// Reserves DDS domains on this machine for one run, so that two runs never hear each other and
/// never compete for ports. A run of many processes overflows the 120 port pairs of its domain into
/// the next ones, which are reserved with it. Held by file locks: a crashed launcher frees them.
class DomainLock {
 public:
  /// `wanted` < 0: the first free block. Fails when the wanted block is in use or none is free.
  static Result<DomainLock> take(int wanted, std::uint32_t participants);

  DomainLock(DomainLock&& other) noexcept;
  DomainLock& operator=(DomainLock&&) = delete;
  ~DomainLock();

  std::uint32_t domain() const { return domain_; }

 private:
  DomainLock() = default;
  std::uint32_t domain_ = 0;
  std::vector<int> files_;
};

}  // namespace swarm::link
