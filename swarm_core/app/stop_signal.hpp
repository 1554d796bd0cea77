// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace swarm::shell {

/// Installs handlers for SIGINT and SIGTERM that only count them, and ignores SIGPIPE and SIGXFSZ.
/// A sleep during which a signal arrives returns early.
void catch_stop_signals();

/// Number of SIGINT and SIGTERM signals so far.
int stop_requests();

}  // namespace swarm::shell
