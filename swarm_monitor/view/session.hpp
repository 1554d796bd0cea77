// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace swarm::monitor {

/// Counters of the server, part of /metrics.
struct ViewCounters {
  std::uint64_t view_frames_sent = 0;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_refused = 0;   ///< malformed, too long, or not allowed
  std::uint64_t samples_skipped = 0;  ///< replaced by newer ones before a slow client took them
  std::uint64_t connections_refused = 0;
};

/// A message to be sent.
struct Outgoing {
  bool binary = false;
  std::vector<std::byte> bytes{};

  void set_text(std::string_view text) {
    binary = false;
    bytes.resize(text.size());
    if (!text.empty()) std::memcpy(bytes.data(), text.data(), text.size());
  }
};

/// One WebSocket client without its socket. It keeps what the client may want next and no queue of
/// samples: its memory does not depend on how slowly the client reads.
class Session {
 public:
  explicit Session(ViewCounters& counters) : counters_(counters) {}
  virtual ~Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Longest frame that is accepted, in bytes.
  virtual std::size_t max_frame() const = 0;
  /// Takes a whole frame, at most max_frame() long.
  virtual void take(std::string_view frame, bool binary) = 0;
  /// Refuses a frame that cannot be taken, and counts it.
  virtual void refuse(const std::string& why) = 0;

  virtual bool has_something() const = 0;
  /// Replaces `out` by the next message; false: there is none.
  virtual bool next(Outgoing& out) = 0;

  /// Whether the client sent too many refused frames and must be disconnected.
  bool hopeless() const { return refused_ >= kMaxRefused; }
  std::uint64_t refused() const { return refused_; }

 protected:
  void count_refused() {
    ++refused_;
    ++counters_.frames_refused;
  }
  ViewCounters& counters() { return counters_; }

 private:
  static constexpr std::uint64_t kMaxRefused = 20;
  ViewCounters& counters_;
  std::uint64_t refused_ = 0;
};

}  // namespace swarm::monitor
