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

/// Takes back that the process which started this one blocked stop signals or SIGCHLD, or ignored
/// SIGCHLD, and ignores SIGPIPE and SIGXFSZ, so that a write fails instead. To be called before the
/// program starts threads and children.
void prepare_signals();

/// prepare_signals(), and handlers for SIGINT and SIGTERM that only count them: for a program that
/// polls stop_requests(). A sleep during which a signal arrives returns early.
void catch_stop_signals(Hangup hangup = Hangup::kIgnore);

/// From now on SIGINT and SIGTERM do what they did before catch_stop_signals(), which is to end the
/// program: it polls no more.
void release_stop_signals();

/// Number of stop signals so far.
int stop_requests();

}  // namespace swarm::shell
