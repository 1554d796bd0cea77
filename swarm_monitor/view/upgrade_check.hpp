// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace swarm::monitor {

/// What a request for a WebSocket has in its head.
struct UpgradeRequest {
  bool get = false;    ///< its method is GET
  std::string http{};  ///< "HTTP/1.1"
  std::string path{};
  std::string host{};
  std::optional<std::string> origin{};  ///< as it is; browsers send it
  std::string upgrade{}, connection{};
  std::string key{}, version{};  ///< Sec-WebSocket-Key, -Version
  std::string protocols{};       ///< Sec-WebSocket-Protocol: names with commas between
};

/// An answer to a request that is not served: the status and a sentence.
struct Refusal {
  int status = 0;
  std::string text{};
};

/// The status 426, which asks for another version of the protocol (RFC 9110, 15.5.22).
inline constexpr int kStatusUpgradeRequired = 426;

/// Protocols of the server: the page's, which is opened to the page alone, and those for any page.
struct ServedProtocols {
  std::string_view page{}, page_path{};
  std::span<const std::string_view> open{};
};

/// Whether a list with commas, such as a Connection header, has the name; case does not count.
bool list_has(std::string_view list, std::string_view name);

/// Why a WebSocket is not opened (RFC 6455, 4.2); nothing if it is. A client that gets no answer
/// reports a failed connection without a reason, and a proxy a status of 502. `names`: as for
/// trusted_host().
std::optional<Refusal> upgrade_refusal(const UpgradeRequest& request, const ServedProtocols& served,
                                       std::span<const std::string> names);

}  // namespace swarm::monitor
