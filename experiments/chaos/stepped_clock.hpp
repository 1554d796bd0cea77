// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// The wall clock of all processes that this one starts while the object exists. It is set as a
/// user or NTP would, for these processes alone: a library that is preloaded into them
/// (clock_shim.cpp) adds an offset. This process and its steady clock are not affected.
class SteppedClock {
 public:
  /// `file` holds the offset and is removed at the end. kEnvironment if the library is not there.
  static Result<std::unique_ptr<SteppedClock>> make(const std::filesystem::path& file);
  ~SteppedClock();
  SteppedClock(const SteppedClock&) = delete;
  SteppedClock& operator=(const SteppedClock&) = delete;

  /// Sets the clock forward, or back if negative.
  void step(std::int64_t seconds);

 private:
  SteppedClock(std::filesystem::path file, volatile std::int64_t* offset_s)
      : file_(std::move(file)), offset_s_(offset_s) {}

  std::filesystem::path file_;
  volatile std::int64_t* offset_s_;  ///< mapped, also by the processes
};

}  // namespace swarm::launcher
