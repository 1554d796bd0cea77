// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

/// The text of the files of idl/, which recordings contain: readers need nothing else to decode
/// them.
namespace swarm::mcap {

/// The constants and the named structs of idl/swarm.idl, in the order given, without comments.
std::string wire_idl(const std::vector<std::string_view>& structs);

/// The same from idl/blackbox.idl, for robot logs.
std::string blackbox_idl(const std::vector<std::string_view>& structs);

}  // namespace swarm::mcap
