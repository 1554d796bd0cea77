// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <utility>

#include "swarmflow/core/result.hpp"

namespace swarm::mcap {

/// A file's bytes, as they were when it was opened.
class MappedFile {
 public:
  /// Maps a regular file for reading; kEnvironment if it cannot be opened or is no regular file.
  static Result<MappedFile> open(const std::filesystem::path& file);
  MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}
  MappedFile& operator=(MappedFile&& other) noexcept {
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~MappedFile();

  /// All bytes; valid as long as this object.
  std::span<const unsigned char> bytes() const { return bytes_; }

 private:
  explicit MappedFile(std::span<const unsigned char> bytes) : bytes_(bytes) {}
  std::span<const unsigned char> bytes_;
};

}  // namespace swarm::mcap
