// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/view_server.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>
#include <libwebsockets.h>
#include <sys/socket.h>
#include <unistd.h>

#include "swarm_core/base/clock.hpp"
#include "swarm_monitor/view/foxglove_feed.hpp"
#include "swarm_monitor/view/foxglove_session.hpp"
#include "swarm_monitor/view/http_reply.hpp"
#include "swarm_monitor/view/listen_check.hpp"
#include "swarm_monitor/view/origin_check.hpp"
#include "swarm_monitor/view/upgrade_check.hpp"

namespace swarm::monitor {
namespace {

/// Protocol name and path of the page's WebSocket; sizes of buffers; periods of pings and of giving
/// up a silent client [s].
constexpr const char* kPageProtocol = "swarmflow.view.v1";
constexpr std::string_view kPagePath = "/ws";
constexpr std::array<std::string_view, 2> kFoxgloveProtocols = {"foxglove.sdk.v1",
                                                                "foxglove.websocket.v1"};
constexpr std::string_view kHttp11 = "HTTP/1.1";
constexpr std::size_t kReceive = 4096;
constexpr std::size_t kSend = 1024 * 1024;  // what one call offers to the kernel
constexpr unsigned kMaxHeaders = 4096;
constexpr std::uint16_t kPing_s = 20;
constexpr std::uint16_t kHangUp_s = 40;

enum ProtocolId : unsigned { kHttp, kPage, kFoxglove };

/// A header of the request; empty if it is missing or longer than 511 characters, which no accepted
/// header is.
std::string header(lws* socket, lws_token_indexes which) {
  std::array<char, 512> text{};
  const int size = lws_hdr_copy(socket, text.data(), static_cast<int>(text.size()), which);
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : std::string();
}

/// This machine's host name: the page may be opened under it.
std::string own_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

/// Prints the first ten errors of libwebsockets alone: any client can cause them, and they must not
/// fill a disk.
void log_error(int, const char* line) {
  static int left = 10;
  if (left == 0) return;
  --left;
  std::fputs(line, stderr);
}

/// Headers of every answer: scripts load from this server alone, and no page may frame this one.
struct Headers {
  lws_protocol_vhost_options referrer{nullptr, nullptr, "referrer-policy:", "no-referrer"};
  lws_protocol_vhost_options cache{&referrer, nullptr, "cache-control:", "no-store"};
  lws_protocol_vhost_options sniff{&cache, nullptr, "x-content-type-options:", "nosniff"};
  lws_protocol_vhost_options policy{
      &sniff, nullptr, "content-security-policy:",
      "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' "
      "data:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"};
};
const Headers kHeaders;

}  // namespace

class ViewServer::Impl {
 public:
  Impl(ViewServerOptions options, ViewSource& source)
      : options_(std::move(options)),
        source_(source),
        feed_(source),
        session_id_(fmt::format("{}", utc_now().time_since_epoch().count())) {
    options_.host_names.push_back(own_name());
  }
  ~Impl() {
    if (context_ != nullptr) lws_context_destroy(context_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Result<void> listen();
  void serve(Duration timeout);
  std::uint16_t port() const { return port_; }
  std::size_t clients() const { return clients_.size(); }
  const ViewCounters& counters() const { return counters_; }

 private:
  struct Client {
    std::unique_ptr<Session> session;
    std::string input;      // of a frame that comes in parts
    bool too_long = false;  // its rest is not taken
  };

  static int on_event(lws* socket, lws_callback_reasons reason, void*, void* in, std::size_t size);
  int on_http(lws* socket, lws_callback_reasons reason, std::string_view in);
  int on_websocket(lws* socket, lws_callback_reasons reason, std::string_view in);

  HttpReply reply_to(lws* socket, std::string_view path) const;
  bool may_open(lws* socket);
  std::unique_ptr<Session> make_session(lws* socket);
  int receive(lws* socket, Client& client, std::string_view part);
  int send(lws* socket, Client& client);
  Result<std::string> control(const ControlRequest& request) const;
  std::string metrics() const;

  ViewServerOptions options_;
  ViewSource& source_;
  FoxgloveFeed feed_;
  std::string session_id_;
  ViewCounters counters_;
  lws_context* context_ = nullptr;
  std::uint16_t port_ = 0;
  lws_sorted_usec_list_t wake_ = {};
  std::unordered_set<lws*> connections_;
  std::unordered_map<lws*, HttpReply> replies_;
  std::unordered_map<lws*, Client> clients_;
  Outgoing outgoing_;
  std::vector<unsigned char> send_buffer_;
};

Result<void> ViewServer::Impl::listen() {
  if (const auto free = can_bind(options_.address, options_.port); !free) return free;
  static const std::array<lws_protocols, 5> kProtocols = {{
      {"http-only", on_event, 0, kReceive, kHttp, nullptr, kSend},
      {kPageProtocol, on_event, 0, kReceive, kPage, nullptr, kSend},
      {kFoxgloveProtocols[0].data(), on_event, 0, kReceive, kFoxglove, nullptr, kSend},
      {kFoxgloveProtocols[1].data(), on_event, 0, kReceive, kFoxglove, nullptr, kSend},
      {nullptr, nullptr, 0, 0, 0, nullptr, 0},
  }};
  // Pings find clients that disappeared without closing.
  static const lws_retry_bo_t kLiveness = {nullptr, 0, 0, kPing_s, kHangUp_s, 0};
  lws_set_log_level(0, nullptr);  // failures here are reported below

  lws_context_creation_info info = {};
  const bool everywhere = options_.address == "0.0.0.0" || options_.address == "::";
  info.iface = everywhere ? nullptr : options_.address.c_str();
  info.port = options_.port;
  info.protocols = kProtocols.data();
  info.headers = &kHeaders.policy;
  info.server_string = "swarmflow";
  info.max_http_header_data = kMaxHeaders;
  info.max_http_header_pool = kMaxConnections;
  info.retry_and_idle_policy = &kLiveness;
  // As many descriptors as it needs: otherwise tables are made for as many as the process may have.
  info.fd_limit_per_thread = kMaxConnections + 16;
  info.options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
  if (options_.address.find(':') == std::string::npos)
    info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
  info.gid = -1;
  info.uid = -1;
  info.user = this;
  context_ = lws_create_context(&info);
  lws_set_log_level(LLL_ERR, log_error);
  lws_vhost* const vhost =
      context_ != nullptr ? lws_get_vhost_by_name(context_, "default") : nullptr;
  if (vhost == nullptr) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("cannot listen on {} port {}", options_.address, options_.port));
  }
  port_ = static_cast<std::uint16_t>(lws_get_vhost_listen_port(vhost));
  return {};
}

/// One step of the only thread: poll the source, feed Foxglove, mark writable sockets, and let
/// libwebsockets serve them.
void ViewServer::Impl::serve(Duration timeout) {
  const UtcTime now = utc_now();
  source_.poll(now);
  std::vector<FoxgloveSession*> sessions;
  for (const auto& [socket, client] : clients_) {
    if (auto* session = dynamic_cast<FoxgloveSession*>(client.session.get())) {
      sessions.push_back(session);
    }
  }
  feed_.step(now, sessions);
  for (const auto& [socket, client] : clients_) {
    if (client.session->has_something()) lws_callback_on_writable(socket);
  }
  // libwebsockets waits for its next timer at most: a timer at `timeout` bounds the wait.
  const auto timeout_us = std::chrono::duration_cast<std::chrono::microseconds>(timeout).count();
  lws_sul_schedule(
      context_, 0, &wake_, [](lws_sorted_usec_list_t*) {}, std::max<lws_usec_t>(timeout_us, 1));
  lws_service(context_, timeout_us <= 0 ? -1 : 0);
}

/// All callbacks of libwebsockets. Connections are limited here, before anything of a request is
/// read.
int ViewServer::Impl::on_event(lws* socket, lws_callback_reasons reason, void*, void* in,
                               std::size_t size) {
  auto& self = *static_cast<Impl*>(lws_context_user(lws_get_context(socket)));
  const std::string_view text =
      in != nullptr ? std::string_view(static_cast<const char*>(in), size) : std::string_view();
  switch (reason) {
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION:
      if (self.connections_.size() < kMaxConnections) return 0;
      ++self.counters_.connections_refused;
      return 1;
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
      self.connections_.insert(socket);
      return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
      return self.may_open(socket) ? 0 : -1;
    case LWS_CALLBACK_WSI_DESTROY:
      self.connections_.erase(socket);
      self.replies_.erase(socket);
      self.clients_.erase(socket);
      return 0;
    default:
      break;
  }
  const lws_protocols* const protocol = lws_get_protocol(socket);
  if (protocol == nullptr) return 0;
  return protocol->id == kHttp ? self.on_http(socket, reason, text)
                               : self.on_websocket(socket, reason, text);
}

/// HTTP serves the page's files and /metrics; a reply is sent in parts, see HttpReply.
int ViewServer::Impl::on_http(lws* socket, lws_callback_reasons reason, std::string_view in) {
  switch (reason) {
    case LWS_CALLBACK_HTTP: {
      const auto [at, is_new] = replies_.insert_or_assign(socket, reply_to(socket, in));
      return at->second.begin(socket) ? 0 : -1;
    }
    case LWS_CALLBACK_HTTP_WRITEABLE: {
      const auto reply = replies_.find(socket);
      if (reply == replies_.end()) return 0;
      return reply->second.go_on(socket) ? 0 : -1;
    }
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return -1;  // "http-only" as the name of a WebSocket's protocol
    default:
      return 0;
  }
}

HttpReply ViewServer::Impl::reply_to(lws* socket, std::string_view path) const {
  const bool head = lws_hdr_total_length(socket, WSI_TOKEN_HEAD_URI) > 0;
  if (!head && lws_hdr_total_length(socket, WSI_TOKEN_GET_URI) <= 0) {
    return HttpReply::text(HTTP_STATUS_METHOD_NOT_ALLOWED, "only GET and HEAD\n");
  }
  // RFC 9112, 3.2; HTTP/1.0 has no Host.
  const bool host_needed = header(socket, WSI_TOKEN_HTTP) == kHttp11;
  HttpReply reply = host_needed && header(socket, WSI_TOKEN_HOST).empty()
                        ? HttpReply::text(HTTP_STATUS_BAD_REQUEST, "the Host header is missing\n")
                    : path == "/metrics" ? HttpReply::text(HTTP_STATUS_OK, metrics())
                                         : page_reply(path);
  return head ? std::move(reply).without_body() : std::move(reply);
}

/// A client is a session with an input buffer; may_open() has decided about its access.
int ViewServer::Impl::on_websocket(lws* socket, lws_callback_reasons reason, std::string_view in) {
  if (reason == LWS_CALLBACK_ESTABLISHED) {
    Client& client = clients_[socket];
    client.session = make_session(socket);
    // A small kernel buffer: frames that wait in the kernel are old when a slow client reads them,
    // and by default megabytes would.
    constexpr int kHeldBytes = 256 << 10;
    ::setsockopt(lws_get_socket_fd(socket), SOL_SOCKET, SO_SNDBUF, &kHeldBytes, sizeof kHeldBytes);
    if (client.session->has_something()) lws_callback_on_writable(socket);
    return 0;
  }
  const auto client = clients_.find(socket);
  if (client == clients_.end()) return 0;
  switch (reason) {
    case LWS_CALLBACK_RECEIVE:
      return receive(socket, client->second, in);
    case LWS_CALLBACK_SERVER_WRITEABLE:
      return send(socket, client->second);
    case LWS_CALLBACK_CLOSED:
      clients_.erase(client);
      return 0;
    default:
      return 0;
  }
}

/// Decides before the upgrade, since libwebsockets closes what it cannot upgrade without an answer.
/// A refusal is short enough for one write; then the connection is closed.
bool ViewServer::Impl::may_open(lws* socket) {
  UpgradeRequest request{.get = lws_hdr_total_length(socket, WSI_TOKEN_GET_URI) > 0,
                         .http = header(socket, WSI_TOKEN_HTTP),
                         .path = header(socket, WSI_TOKEN_GET_URI),
                         .host = header(socket, WSI_TOKEN_HOST),
                         .upgrade = header(socket, WSI_TOKEN_UPGRADE),
                         .connection = header(socket, WSI_TOKEN_CONNECTION),
                         .key = header(socket, WSI_TOKEN_KEY),
                         .version = header(socket, WSI_TOKEN_VERSION),
                         .protocols = header(socket, WSI_TOKEN_PROTOCOL)};
  if (lws_hdr_total_length(socket, WSI_TOKEN_ORIGIN) > 0) {
    request.origin = header(socket, WSI_TOKEN_ORIGIN);
  }
  const ServedProtocols served{kPageProtocol, kPagePath, kFoxgloveProtocols};
  const auto refusal = upgrade_refusal(request, served, options_.host_names);
  if (!refusal) return true;
  ++counters_.connections_refused;
  HttpReply reply = HttpReply::text(refusal->status, refusal->text + '\n');
  if (reply.begin(socket)) reply.go_on(socket);
  return false;
}

std::unique_ptr<Session> ViewServer::Impl::make_session(lws* socket) {
  if (lws_get_protocol(socket)->id == kPage) {
    return std::make_unique<PageSession>(
        source_, [this](const ControlRequest& request) { return control(request); }, counters_);
  }
  return std::make_unique<FoxgloveSession>(
      feed_.channels(), session_id_,
      [this](std::uint32_t channel) { return feed_.newest(channel); }, counters_);
}

/// Collects the fragments of a frame up to the session's limit; a longer frame is dropped as a
/// whole and counts as refused.
int ViewServer::Impl::receive(lws* socket, Client& client, std::string_view part) {
  Session& session = *client.session;
  client.too_long = client.too_long || client.input.size() + part.size() > session.max_frame();
  if (client.too_long) {
    client.input.clear();
  } else {
    client.input += part;
  }
  if (lws_is_final_fragment(socket) == 0) return 0;
  ++counters_.frames_received;
  if (std::exchange(client.too_long, false)) {
    session.refuse(fmt::format("longer than {} bytes", session.max_frame()));
  } else {
    session.take(client.input, lws_frame_is_binary(socket) != 0);
  }
  client.input.clear();
  if (session.hopeless()) {
    lws_close_reason(socket, LWS_CLOSE_STATUS_POLICY_VIOLATION, nullptr, 0);
    return -1;
  }
  if (session.has_something()) lws_callback_on_writable(socket);
  return 0;
}

int ViewServer::Impl::send(lws* socket, Client& client) {
  // Called when the socket has accepted the previous message: at most one message is in flight per
  // client.
  if (!client.session->next(outgoing_)) return 0;
  const std::size_t size = outgoing_.bytes.size();
  send_buffer_.resize(LWS_PRE + size);
  if (size > 0) std::memcpy(send_buffer_.data() + LWS_PRE, outgoing_.bytes.data(), size);
  if (lws_write(socket, send_buffer_.data() + LWS_PRE, size,
                outgoing_.binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT) < static_cast<int>(size)) {
    return -1;
  }
  if (client.session->has_something()) lws_callback_on_writable(socket);
  return 0;
}

/// Controlling needs the option at the start and the token of the printed address.
Result<std::string> ViewServer::Impl::control(const ControlRequest& request) const {
  if (!options_.allow_control || !options_.control) {
    return fail(ErrorCode::kBadInput, "this view only shows: it was started without control");
  }
  if (!same_token(request.token, options_.token)) {
    return fail(ErrorCode::kBadInput, "wrong token");
  }
  return options_.control(request);
}

std::string ViewServer::Impl::metrics() const {
  std::string text = source_.metrics();
  if (!text.empty() && text.back() != '\n') text += '\n';
  const auto add = [&](std::string_view name, std::string_view type, std::uint64_t value) {
    text += fmt::format("# TYPE swarm_view_{0} {1}\nswarm_view_{0} {2}\n", name, type, value);
  };
  add("clients", "gauge", clients_.size());
  add("pictures_sent_total", "counter", counters_.view_frames_sent);
  add("frames_received_total", "counter", counters_.frames_received);
  add("frames_refused_total", "counter", counters_.frames_refused);
  add("samples_skipped_total", "counter", counters_.samples_skipped);
  add("connections_refused_total", "counter", counters_.connections_refused);
  return text;
}

Result<std::unique_ptr<ViewServer>> ViewServer::make(ViewServerOptions options,
                                                     ViewSource& source) {
  if (options.allow_control && options.token.empty()) {
    return fail(ErrorCode::kBadInput, "control over the view needs a token");
  }
  auto impl = std::make_unique<Impl>(std::move(options), source);
  if (const auto listening = impl->listen(); !listening) {
    return tl::unexpected(listening.error());
  }
  return std::unique_ptr<ViewServer>(new ViewServer(std::move(impl)));
}

ViewServer::ViewServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ViewServer::~ViewServer() = default;
void ViewServer::serve(Duration timeout) { impl_->serve(timeout); }
std::uint16_t ViewServer::port() const { return impl_->port(); }
std::size_t ViewServer::clients() const { return impl_->clients(); }
const ViewCounters& ViewServer::counters() const { return impl_->counters(); }

}  // namespace swarm::monitor
