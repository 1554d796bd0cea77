// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace swarm::shell {

/// Installs handlers for SIGINT and SIGTERM that only count; SIGPIPE and SIGXFSZ are ignored.
/// Sleeps return early.
void catch_stop_signals();

/// How often the user asked to stop so far.
int stop_requests();

}  // namespace swarm::shell
