// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

/// The files of idl/, for recordings to carry: readers need nothing else to make sense of them.
namespace swarm::mcap {

/// Of idl/swarm.idl the constants and these structs alone, in the order given, without comments.
std::string wire_idl(const std::vector<std::string_view>& structs);

/// The same of idl/blackbox.idl: every robot's file carries them.
std::string blackbox_idl(const std::vector<std::string_view>& structs);

}  // namespace swarm::mcap
