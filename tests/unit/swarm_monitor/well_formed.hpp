// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace swarm::monitor {

/// What is wrong with an XML text as far as tags, quotes and entities go; empty if nothing is. Also
/// complains about numbers that are not finite.
std::string xml_fault(std::string_view text);

/// Number of occurrences of a text.
std::size_t count_of(std::string_view text, std::string_view word);

}  // namespace swarm::monitor
