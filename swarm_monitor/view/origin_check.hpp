// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

/// Who may open the page's WebSocket: browsers let any site connect anywhere, and leave it to the
/// server to look where a request comes from.
namespace swarm::monitor {

/// The page that asks ("http://127.0.0.1:8080") was served by the host it asks ("127.0.0.1:8080").
/// No origin at all: not a browser.
bool same_origin(std::string_view origin, std::string_view host);

/// An address, localhost or one of `names`. Any other name may have been pointed here by a site
/// that wants its own scripts to pass for ours.
bool trusted_host(std::string_view host, std::span<const std::string> names);

/// Takes the same time wherever the two differ.
bool same_token(std::string_view given, std::string_view token);

}  // namespace swarm::monitor
