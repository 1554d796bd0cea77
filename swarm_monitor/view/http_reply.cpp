// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/http_reply.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <libwebsockets.h>

#include "swarm_monitor/view/page_files.hpp"
#include "swarm_monitor/view/upgrade_check.hpp"

namespace swarm::monitor {
namespace {

/// Bytes per write, and how long the client may take to accept them.
constexpr std::size_t kPart = 16 * 1024;
constexpr int kTimeout_s = 20;  // for a part

}  // namespace

HttpReply HttpReply::text(int status, std::string body) {
  HttpReply reply;
  reply.status_ = status;
  reply.mime_ = "text/plain; charset=utf-8";
  reply.own_ = std::move(body);
  return reply;
}

HttpReply HttpReply::file(std::string_view mime, std::span<const unsigned char> bytes) {
  HttpReply reply;
  reply.mime_ = mime;
  reply.shared_ = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  return reply;
}

HttpReply HttpReply::without_body() && {
  headers_only_ = true;
  return std::move(*this);
}

/// Headers only; the body follows in go_on() whenever the socket is writable.
bool HttpReply::begin(lws* socket) const {
  std::array<unsigned char, LWS_PRE + 2048> buffer{};
  unsigned char* const begin = buffer.data() + LWS_PRE;
  unsigned char* const end = buffer.data() + buffer.size() - 1;
  unsigned char* at = begin;
  if (lws_add_http_common_headers(socket, static_cast<unsigned>(status_), mime_.c_str(),
                                  body().size(), &at, end) != 0) {
    return false;
  }
  const auto add = [&](const char* name, std::string_view value) {
    return lws_add_http_header_by_name(socket, reinterpret_cast<const unsigned char*>(name),
                                       reinterpret_cast<const unsigned char*>(value.data()),
                                       static_cast<int>(value.size()), &at, end) == 0;
  };
  if (status_ == HTTP_STATUS_METHOD_NOT_ALLOWED && !add("allow:", "GET, HEAD")) return false;
  if (status_ == kStatusUpgradeRequired &&
      !(add("upgrade:", "websocket") && add("sec-websocket-version:", "13"))) {
    return false;
  }
  if (closes() && !add("connection:", "close")) return false;
  if (lws_finalize_write_http_header(socket, begin, &at, end) != 0) return false;
  lws_callback_on_writable(socket);
  return true;
}

/// After a malformed request the connection is closed: what follows on it cannot be parsed
/// reliably.
bool HttpReply::closes() const { return status_ != HTTP_STATUS_OK; }

/// Sends the next part. The buffer has LWS_PRE bytes in front, which libwebsockets needs for its
/// own framing.
bool HttpReply::go_on(lws* socket) {
  if (headers_only_) return !closes() && lws_http_transaction_completed(socket) == 0;
  std::array<unsigned char, LWS_PRE + kPart> buffer;
  const std::size_t size = std::min(kPart, body().size() - sent_);
  const bool last = sent_ + size == body().size();
  std::memcpy(buffer.data() + LWS_PRE, body().data() + sent_, size);
  lws_set_timeout(socket, PENDING_TIMEOUT_HTTP_CONTENT, kTimeout_s);
  if (lws_write(socket, buffer.data() + LWS_PRE, size,
                last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < static_cast<int>(size)) {
    return false;
  }
  sent_ += size;
  if (!last) {
    lws_callback_on_writable(socket);
    return true;
  }
  return !closes() && lws_http_transaction_completed(socket) == 0;
}

HttpReply page_reply(std::string_view path) {
  const auto files = page_files();
  const auto file = std::find_if(files.begin(), files.end(),
                                 [&](const PageFile& known) { return known.path == path; });
  if (file == files.end()) return HttpReply::text(HTTP_STATUS_NOT_FOUND, "not found\n");
  return HttpReply::file(file->mime, file->bytes);
}

}  // namespace swarm::monitor
