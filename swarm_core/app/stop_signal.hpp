// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace swarm::shell {

/// What the end of the terminal, SIGHUP, does to a program.
enum class Hangup : unsigned char {
  kIgnore,  ///< goes on: robots are in flight, or hours of results would be lost
  kStop,    ///< counts as a stop signal: the program shows something to its user
};

/// Installs handlers for SIGINT and SIGTERM that only count them, and ignores SIGPIPE and SIGXFSZ.
/// A sleep during which a signal arrives returns early.
void catch_stop_signals(Hangup hangup = Hangup::kIgnore);

/// Number of stop signals so far.
int stop_requests();

}  // namespace swarm::shell
