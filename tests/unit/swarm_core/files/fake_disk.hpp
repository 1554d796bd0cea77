// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "swarm_core/files/disk.hpp"

namespace swarm::files {

/// A disk in memory with the faults of real ones. All of it may be used from two threads.
class FakeDisk final : public Disk {
 public:
  // Faults; set them with a lock on `mutex`, or before a second thread exists.
  std::uint64_t room_bytes = UINT64_MAX;  ///< then ENOSPC, after what still fits
  int open_error = 0;
  int write_error = 0;
  int truncate_error = 0;
  std::size_t most_at_once = SIZE_MAX;  ///< bytes that one write takes
  bool is_regular = true;
  bool is_frozen = false;  ///< writes wait until thaw()

  mutable std::mutex mutex;
  std::condition_variable changed;
  int waiting_writes = 0;  ///< that a frozen disk holds
  int closed = 0;
  int writes = 0;

  std::string content(const std::filesystem::path& file) const {
    const std::lock_guard lock(mutex);
    const auto found = files_.find(file);
    return found == files_.end() ? "" : found->second->content;
  }
  bool has(const std::filesystem::path& file) const {
    const std::lock_guard lock(mutex);
    return files_.contains(file);
  }
  void set_content(const std::filesystem::path& file, std::string content) {
    const std::lock_guard lock(mutex);
    inode(file).content = std::move(content);
  }
  /// As by rm: who has the file open keeps it.
  void unlink(const std::filesystem::path& file) {
    const std::lock_guard lock(mutex);
    files_[file]->is_linked = false;
    files_.erase(file);
  }
  void fill(std::uint64_t room) {
    const std::lock_guard lock(mutex);
    room_bytes = room;
  }
  void freeze() {
    const std::lock_guard lock(mutex);
    is_frozen = true;
  }
  void thaw() {
    const std::lock_guard lock(mutex);
    is_frozen = false;
    changed.notify_all();
  }
  /// Waits until a write waits for the frozen disk.
  void wait_for_a_write() {
    std::unique_lock lock(mutex);
    changed.wait(lock, [this] { return waiting_writes > 0; });
  }

  Answer<int> open(const std::filesystem::path& file) override {
    const std::lock_guard lock(mutex);
    if (open_error != 0) return tl::unexpected(open_error);
    inode(file);
    open_[next_fd_] = files_[file];
    return next_fd_++;
  }
  Answer<State> state(int fd) override {
    const std::lock_guard lock(mutex);
    const Inode& inode = *open_.at(fd);
    return State{
        .size = inode.content.size(), .is_regular = is_regular, .is_linked = inode.is_linked};
  }
  Answer<std::size_t> write(int fd, std::span<const unsigned char> bytes) override {
    std::unique_lock lock(mutex);
    ++writes;
    wait_while_frozen(lock);
    if (write_error != 0) return tl::unexpected(write_error);
    const std::size_t taken = std::min<std::uint64_t>({bytes.size(), room_bytes, most_at_once});
    if (taken == 0) return tl::unexpected(ENOSPC);
    if (room_bytes != UINT64_MAX) room_bytes -= taken;
    open_.at(fd)->content.append(reinterpret_cast<const char*>(bytes.data()), taken);
    return taken;
  }
  Answer<std::size_t> read_at(int fd, std::uint64_t offset,
                              std::span<unsigned char> bytes) override {
    const std::lock_guard lock(mutex);
    const std::string& content = open_.at(fd)->content;
    const std::size_t read = std::min<std::size_t>(bytes.size(), content.size() - offset);
    std::copy_n(content.begin() + static_cast<std::ptrdiff_t>(offset), read, bytes.begin());
    return read;
  }
  int truncate(int fd, std::uint64_t size) override {
    const std::lock_guard lock(mutex);
    if (truncate_error != 0) return truncate_error;
    std::string& content = open_.at(fd)->content;
    if (room_bytes != UINT64_MAX) room_bytes += content.size() - size;
    content.resize(size);
    return 0;
  }
  void close(int fd) override {
    const std::lock_guard lock(mutex);
    ++closed;
    open_.erase(fd);
  }
  int replace(const std::filesystem::path& file, std::string_view content) override {
    std::unique_lock lock(mutex);
    ++writes;
    wait_while_frozen(lock);
    if (write_error != 0) return write_error;
    if (content.size() > room_bytes) return ENOSPC;
    inode(file).content = content;
    return 0;
  }
  int remove(const std::filesystem::path& file) override {
    const std::lock_guard lock(mutex);
    if (write_error != 0) return write_error;
    files_.erase(file);
    return 0;
  }
  bool exists(const std::filesystem::path& file) override { return has(file); }

 private:
  struct Inode {
    std::string content;
    bool is_linked = true;
  };
  Inode& inode(const std::filesystem::path& file) {
    auto& found = files_[file];
    if (!found) found = std::make_shared<Inode>();
    return *found;
  }
  void wait_while_frozen(std::unique_lock<std::mutex>& lock) {
    if (!is_frozen) return;
    ++waiting_writes;
    changed.notify_all();
    changed.wait(lock, [this] { return !is_frozen; });
    --waiting_writes;
  }

  std::map<std::filesystem::path, std::shared_ptr<Inode>> files_;
  std::map<int, std::shared_ptr<Inode>> open_;
  int next_fd_ = 3;
};

inline std::span<const unsigned char> bytes_of(std::string_view text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}
inline std::vector<unsigned char> to_bytes(std::string_view text) {
  return {text.begin(), text.end()};
}

}  // namespace swarm::files
