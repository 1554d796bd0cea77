// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace swarm::monitor {

/// A whole HTML page around `body`: style sheet for light, dark and print, and the few lines of
/// script that sort tables of class "sortable" by the clicked column. `title` is plain text.
std::string report_page(std::string_view title, std::string_view body);

}  // namespace swarm::monitor
