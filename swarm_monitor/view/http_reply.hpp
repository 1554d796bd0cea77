// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

struct lws;

namespace swarm::monitor {

/// The answer to one HTTP request, sent in parts.
class HttpReply {
 public:
  static HttpReply text(int status, std::string body);
  /// `bytes` stay where they are until the answer is out.
  static HttpReply file(std::string_view mime, std::span<const unsigned char> bytes);

  int status() const { return status_; }
  /// The answer to HEAD: the same headers, and no body (RFC 9110, 9.3.2).
  HttpReply without_body() &&;
  /// Sends status and headers. False: the connection must be closed.
  bool begin(lws* socket) const;
  /// Sends the next part of the body, or ends the answer. False: the connection must be closed.
  bool go_on(lws* socket);

 private:
  bool closes() const;
  std::string_view body() const { return shared_.empty() ? own_ : shared_; }

  int status_ = 200;
  std::string mime_;
  std::string own_;
  std::string_view shared_;
  std::size_t sent_ = 0;
  bool headers_only_ = false;
};

/// The answer to "GET /name". Only exact names of embedded files are known, so that no path leads
/// anywhere else.
HttpReply page_reply(std::string_view path);

}  // namespace swarm::monitor
