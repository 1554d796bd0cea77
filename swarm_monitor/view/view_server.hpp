// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "swarm_monitor/view/page_session.hpp"
#include "swarm_monitor/view/session.hpp"
#include "swarm_monitor/view/view_source.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::monitor {

struct ViewServerOptions {
  std::string address = "127.0.0.1";  ///< "0.0.0.0", "::": every interface
  std::uint16_t port = 0;             ///< 0: a free one
  /// Names, beside addresses, localhost and this machine's own, under which the page may be opened.
  std::vector<std::string> host_names{};
  bool allow_control = false;
  std::string token{};  ///< required in every control request
  Control control{};    ///< called in serve()
};

/// The live view: serves the page and its WebSocket (PROTOCOL.md), Foxglove clients and /metrics.
/// One thread.
class ViewServer {
 public:
  static constexpr std::size_t kMaxConnections = 64;

  /// Listens. The source has to outlive the server.
  static Result<std::unique_ptr<ViewServer>> make(ViewServerOptions options, ViewSource& source);
  ~ViewServer();

  /// One step: polls the source and serves the sockets; waits at most `timeout`.
  void serve(Duration timeout);

  std::uint16_t port() const;
  /// WebSockets, of the page and of Foxglove.
  std::size_t clients() const;
  const ViewCounters& counters() const;

 private:
  class Impl;
  explicit ViewServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace swarm::monitor
