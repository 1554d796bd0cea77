// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "swarm_core/base/assert.hpp"

namespace swarm::shell {

/// Blocks of bytes from one thread to another, in memory that is reserved once. One thread pushes,
/// another one copies and pops; neither ever blocks the other. A ring that is kept empty stays in
/// the first half of its memory, so that the other half is never touched.
class RecordRing {
 public:
  /// Blocks that copy() found, for pop().
  struct Taken {
    std::uint64_t until = 0;    ///< position behind them
    std::uint64_t records = 0;  ///< in them
  };

  explicit RecordRing(std::size_t capacity_bytes)
      : capacity_((capacity_bytes + kAlign - 1) / kAlign * kAlign),
        bytes_(std::make_unique_for_overwrite<unsigned char[]>(capacity_)) {
    SWARM_ASSERT(capacity_ >= 2 * sizeof(Front));
  }

  /// Producer: adds a block of some records. False if it does not fit.
  bool push(std::span<const unsigned char> block, std::uint32_t records) {
    const std::size_t need = sizeof(Front) + (block.size() + kAlign - 1) / kAlign * kAlign;
    std::uint64_t begin = written_.load(std::memory_order_relaxed);
    const std::uint64_t read = read_.load(std::memory_order_acquire);
    const std::size_t offset = begin % capacity_;
    const std::size_t to_end = capacity_ - offset;
    // Blocks are contiguous. An empty ring goes back to its begin, where memory is in use already.
    // Until the consumer has passed what is skipped, only what lies before it can be used: so at
    // least half of the ring.
    const bool wraps =
        need > to_end || (begin == read && offset >= need && offset >= capacity_ / 2);
    const std::size_t skipped = wraps ? to_end : 0;
    if (need + skipped > capacity_ - (begin - read)) return false;
    if (wraps) {
      put_front(offset, {.length = kSkip});
      begin += to_end;
    }
    const std::size_t at = begin % capacity_;
    put_front(at, {.length = static_cast<std::uint32_t>(block.size()), .records = records});
    std::memcpy(bytes_.get() + at + sizeof(Front), block.data(), block.size());
    written_.store(begin + need, std::memory_order_release);
    return true;
  }

  /// Consumer: appends the oldest blocks to `out`, at least one and no more than `most_bytes`
  /// beyond it. They stay in the ring.
  Taken copy(std::vector<unsigned char>& out, std::size_t most_bytes) {
    pass_skip();
    return collect(out, most_bytes);
  }

  /// Consumer: frees the room of what copy() found.
  void pop(const Taken& taken) { read_.store(taken.until, std::memory_order_release); }

  bool is_empty() const {
    return read_.load(std::memory_order_acquire) == written_.load(std::memory_order_acquire);
  }
  /// Consumer: number of records that wait.
  std::uint64_t waiting() const {
    std::vector<unsigned char> ignored;
    return collect(ignored, capacity_).records;
  }

 private:
  struct Front {
    std::uint32_t length = 0;   ///< bytes of the block behind it, or kSkip
    std::uint32_t records = 0;  ///< in the block
  };
  static constexpr std::size_t kAlign = sizeof(Front);
  static constexpr std::uint32_t kSkip = UINT32_MAX;  ///< the next block is at the begin

  // Frees what was skipped at once, and not with the first block behind it: while that cannot be
  // written, a ring that went back to its begin early would have no more room than it had used.
  void pass_skip() {
    const std::uint64_t read = read_.load(std::memory_order_relaxed);
    if (read == written_.load(std::memory_order_acquire)) return;
    const std::size_t at = read % capacity_;
    Front front;
    std::memcpy(&front, bytes_.get() + at, sizeof(front));
    if (front.length == kSkip) read_.store(read + capacity_ - at, std::memory_order_release);
  }

  Taken collect(std::vector<unsigned char>& out, std::size_t most_bytes) const {
    Taken taken{.until = read_.load(std::memory_order_relaxed)};
    const std::uint64_t end = written_.load(std::memory_order_acquire);
    std::size_t copied = 0;
    while (taken.until != end) {
      const std::size_t at = taken.until % capacity_;
      Front front;
      std::memcpy(&front, bytes_.get() + at, sizeof(front));
      if (front.length == kSkip) {
        taken.until += capacity_ - at;
        continue;
      }
      if (taken.records > 0 && copied + front.length > most_bytes) break;
      const unsigned char* block = bytes_.get() + at + sizeof(front);
      out.insert(out.end(), block, block + front.length);
      copied += front.length;
      taken.records += front.records;
      taken.until += sizeof(front) + (front.length + kAlign - 1) / kAlign * kAlign;
    }
    return taken;
  }

  void put_front(std::size_t at, const Front& front) {
    std::memcpy(bytes_.get() + at, &front, sizeof(front));
  }

  std::size_t capacity_;
  std::unique_ptr<unsigned char[]> bytes_;
  // Ever growing; the place in memory is the remainder by the capacity.
  alignas(64) std::atomic<std::uint64_t> written_{0};
  alignas(64) std::atomic<std::uint64_t> read_{0};
};

}  // namespace swarm::shell
