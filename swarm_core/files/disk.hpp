// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include <tl/expected.hpp>

namespace swarm::files {

/// What programs need of a file system to write their files. Tests replace it by one that is full,
/// slow or gone. Every call may block for as long as the disk does. Errors are numbers of errno.
class Disk {
 public:
  template <class T>
  using Answer = tl::expected<T, int>;

  /// An open file.
  struct State {
    std::uint64_t size = 0;  ///< bytes
    bool is_regular = true;  ///< false: a device or pipe, which cannot be cut
    bool is_linked = true;   ///< false: it was removed and nothing can be found in it any more
  };

  virtual ~Disk() = default;

  /// Opens a file to append to it, and makes it and its folders where they are missing.
  virtual Answer<int> open(const std::filesystem::path& file) = 0;
  virtual Answer<State> state(int fd) = 0;
  /// Number of bytes that were written, at least one.
  virtual Answer<std::size_t> write(int fd, std::span<const unsigned char> bytes) = 0;
  /// Number of bytes that were read.
  virtual Answer<std::size_t> read_at(int fd, std::uint64_t offset,
                                      std::span<unsigned char> bytes) = 0;
  /// Cuts the file to this size. 0 or the error.
  virtual int truncate(int fd, std::uint64_t size) = 0;
  virtual void close(int fd) = 0;

  /// Writes a whole file under another name and renames it; makes its folder where it is missing.
  /// 0 or the error.
  virtual int replace(const std::filesystem::path& file, std::string_view content) = 0;
  /// Removes a file. 0, also where there was none, or the error.
  virtual int remove(const std::filesystem::path& file) = 0;
  virtual bool exists(const std::filesystem::path& file) = 0;
};

/// The file system of this machine.
class RealDisk : public Disk {
 public:
  Answer<int> open(const std::filesystem::path& file) override;
  Answer<State> state(int fd) override;
  Answer<std::size_t> write(int fd, std::span<const unsigned char> bytes) override;
  Answer<std::size_t> read_at(int fd, std::uint64_t offset,
                              std::span<unsigned char> bytes) override;
  int truncate(int fd, std::uint64_t size) override;
  void close(int fd) override;
  int replace(const std::filesystem::path& file, std::string_view content) override;
  int remove(const std::filesystem::path& file) override;
  bool exists(const std::filesystem::path& file) override;
};

/// One stream that is open already, such as standard error: every file is this stream.
class StreamDisk final : public RealDisk {
 public:
  /// The descriptor is not closed.
  explicit StreamDisk(int fd) : fd_(fd) {}
  Answer<int> open(const std::filesystem::path& file) override;
  Answer<State> state(int fd) override;
  void close(int fd) override;

 private:
  int fd_;
};

}  // namespace swarm::files
