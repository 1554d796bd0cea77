// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace swarm::shell {

/// What the end of the terminal, SIGHUP, does to a program.
enum class Hangup : unsigned char {
  kIgnore,  ///< goes on: another process ends it
  /// Counts as a stop signal, as its user cannot end it by Ctrl-C any more, unless the program was
  /// started to outlive its terminal, as by nohup. However often the signal comes it counts once,
  /// since kernel and shell send one each, and a second stop signal of a user means "at once".
  kStop,
};

/// Installs handlers for SIGINT and SIGTERM that only count them, and ignores SIGPIPE and SIGXFSZ.
/// A sleep during which a signal arrives returns early.
void catch_stop_signals(Hangup hangup = Hangup::kIgnore);

/// Number of stop signals so far.
int stop_requests();

}  // namespace swarm::shell
