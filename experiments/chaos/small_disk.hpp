// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Gives the calling thread mounts of its own: what it and its children mount from now on is there
/// for them alone and disappears with them, however they end. kEnvironment without root.
Result<void> own_mounts();

/// A folder on a file system of its own, in memory, which can be filled. At the end the folder and
/// its content are on the file system around it.
class SmallDisk {
 public:
  /// Makes the folder. \pre own_mounts(). kEnvironment if the machine refuses.
  static Result<std::unique_ptr<SmallDisk>> make(const std::filesystem::path& folder,
                                                 std::uint64_t bytes);
  ~SmallDisk();
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  /// Uses up all space. False if it is used up already.
  bool fill();
  void free();

 private:
  explicit SmallDisk(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::filesystem::path filler() const { return folder_ / "filler"; }

  std::filesystem::path folder_;
  bool is_full_ = false;
};

}  // namespace swarm::launcher
