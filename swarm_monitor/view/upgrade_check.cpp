// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/upgrade_check.hpp"

#include <algorithm>
#include <cctype>
#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "swarm_monitor/view/origin_check.hpp"

namespace swarm::monitor {
namespace {

constexpr int kBadRequest = 400, kForbidden = 403, kNotFound = 404, kMethodNotAllowed = 405;

/// The first member of a list with commas for which `wanted` holds; empty if there is none.
std::string_view first_of(std::string_view list,
                          const std::function<bool(std::string_view)>& wanted) {
  constexpr std::string_view kBlanks = " \t";
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    std::string_view member = list.substr(0, comma);
    list.remove_prefix(std::min(comma + 1, list.size()));
    member.remove_prefix(std::min(member.find_first_not_of(kBlanks), member.size()));
    member = member.substr(0, member.find_last_not_of(kBlanks) + 1);
    if (!member.empty() && wanted(member)) return member;
  }
  return {};
}

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

}  // namespace

bool list_has(std::string_view list, std::string_view name) {
  return !first_of(list, [&](std::string_view member) {
            return equal_ignoring_case(member, name);
          }).empty();
}

/// Names of protocols are compared with case, as the server library does when it chooses one.
std::optional<Refusal> upgrade_refusal(const UpgradeRequest& request, const ServedProtocols& served,
                                       std::span<const std::string> names) {
  if (!request.get) return Refusal{kMethodNotAllowed, "a WebSocket is opened by GET"};
  if (!list_has(request.upgrade, "websocket")) {
    return Refusal{kBadRequest, "the only upgrade here is websocket"};
  }
  if (request.http != "HTTP/1.1" || !list_has(request.connection, "upgrade") ||
      request.host.empty() || request.key.empty()) {
    return Refusal{kBadRequest,
                   "a WebSocket needs HTTP/1.1, Host, Connection: Upgrade and Sec-WebSocket-Key"};
  }
  if (request.version != "13") {
    return Refusal{kStatusUpgradeRequired, "Sec-WebSocket-Version must be 13"};
  }
  const std::string_view protocol = first_of(request.protocols, [&](std::string_view name) {
    return name == served.page || std::count(served.open.begin(), served.open.end(), name) > 0;
  });
  if (protocol.empty()) {
    return Refusal{kBadRequest, fmt::format("Sec-WebSocket-Protocol must have one of: {}, {}",
                                            served.page, fmt::join(served.open, ", "))};
  }
  // Any web page may connect by the open protocols, which only show.
  if (protocol != served.page) return std::nullopt;
  if (request.path != served.page_path) {
    return Refusal{kNotFound, fmt::format("{} is at {}", served.page, served.page_path)};
  }
  const bool trusted = (!request.origin ||
                        (!request.origin->empty() && same_origin(*request.origin, request.host))) &&
                       trusted_host(request.host, names);
  if (!trusted) return Refusal{kForbidden, "opened to the page of this server alone"};
  return std::nullopt;
}

}  // namespace swarm::monitor
