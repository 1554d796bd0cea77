// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

/// Checks of who may open the page's WebSocket: browsers let any site connect anywhere, and leave
/// it to the server to check the origin of a request.
namespace swarm::monitor {

/// Whether the page that connects ("http://127.0.0.1:8080") was served by the host that it connects
/// to ("127.0.0.1:8080"). A request without origin does not come from a browser and passes.
bool same_origin(std::string_view origin, std::string_view host);

/// Whether a host is an address, localhost or one of `names`. Any other name may have been pointed
/// to this machine by a site whose scripts are to pass for ours.
bool trusted_host(std::string_view host, std::span<const std::string> names);

/// Whether the tokens agree, in a time that does not depend on where they differ.
bool same_token(std::string_view given, std::string_view token);

}  // namespace swarm::monitor
