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

/// What the server counts; part of /metrics.
struct ViewCounters {
  std::uint64_t view_frames_sent = 0;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_refused = 0;   ///< malformed, too long, or not allowed
  std::uint64_t samples_skipped = 0;  ///< a newer one came before a slow client took it
  std::uint64_t connections_refused = 0;
};

/// A message under way out.
struct Outgoing {
  bool binary = false;
  std::vector<std::byte> bytes{};

  void set_text(std::string_view text) {
    binary = false;
    bytes.resize(text.size());
    if (!text.empty()) std::memcpy(bytes.data(), text.data(), text.size());
  }
};

/// One WebSocket client without its socket. It holds what the client may want next, never a queue
/// of messages: how much memory a client takes does not depend on how slowly it reads.
class Session {
 public:
  explicit Session(ViewCounters& counters) : counters_(counters) {}
  virtual ~Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  virtual std::size_t max_frame() const = 0;
  /// Takes a whole frame, at most max_frame() long.
  virtual void take(std::string_view frame, bool binary) = 0;
  /// For frames that cannot be taken at all.
  virtual void refuse(const std::string& why) = 0;

  virtual bool has_something() const = 0;
  /// Replaces `out` by the next message; false: there is none.
  virtual bool next(Outgoing& out) = 0;

  /// Nothing good comes from this client: it is to be closed.
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
