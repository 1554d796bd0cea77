// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/origin_check.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include <arpa/inet.h>

namespace swarm::monitor {
namespace {

/// Host names compare without regard to case.
bool same_name(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

/// "host:8080" and "[::1]:8080" without their ports; empty if anything but a port follows the name.
std::string_view without_port(std::string_view host) {
  const bool bracketed = host.starts_with('[');
  const std::size_t end = host.find(bracketed ? ']' : ':');
  if (bracketed && end == std::string_view::npos) return {};
  const std::string_view name = host.substr(0, end);
  std::string_view port = host.substr(std::min(host.size(), bracketed ? end + 1 : end));
  if (!port.empty() && port.front() != ':') return {};
  port.remove_prefix(port.empty() ? 0 : 1);
  const bool is_number =
      std::all_of(port.begin(), port.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  return is_number ? name.substr(bracketed ? 1 : 0) : std::string_view{};
}

bool is_address(const std::string& text) {
  if (text.find('\0') != std::string::npos) return false;  // inet_pton() would read only up to it
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return ::inet_pton(AF_INET, text.c_str(), address.data()) == 1 ||
         ::inet_pton(AF_INET6, text.c_str(), address.data()) == 1;
}

}  // namespace

bool same_origin(std::string_view origin, std::string_view host) {
  if (origin.empty()) return true;
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme)) return same_name(origin.substr(scheme.size()), host);
  }
  return false;  // "null": a local file, or somebody who hides
}

/// Protects against DNS rebinding: a foreign name that resolves to this machine is refused,
/// although origin and host agree.
bool trusted_host(std::string_view host, std::span<const std::string> names) {
  const std::string name(without_port(host));
  return is_address(name) || same_name(name, "localhost") ||
         std::any_of(names.begin(), names.end(),
                     [&](const std::string& known) { return same_name(name, known); });
}

/// Constant time in the position of the first difference, so that answers do not leak how much of a
/// guess was right. An empty token matches nothing.
bool same_token(std::string_view given, std::string_view token) {
  volatile unsigned char differ = given.size() == token.size() ? 0 : 1;
  for (std::size_t i = 0; i < given.size() && !token.empty(); ++i) {
    const char expected = token[i % token.size()];
    differ = static_cast<unsigned char>(differ | (given[i] ^ expected));
  }
  return differ == 0 && !token.empty();
}

}  // namespace swarm::monitor
