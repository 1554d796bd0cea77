// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/stop_signal.hpp"

#include <atomic>
#include <csignal>

namespace swarm::shell {
namespace {

std::atomic<int> requests{0};
static_assert(std::atomic<int>::is_always_lock_free, "used in a signal handler");

// A signal handler may only touch lock-free atomics; the loops of the program poll the count.
void on_signal(int) { requests.fetch_add(1, std::memory_order_relaxed); }

std::atomic<bool> hung_up{false};
static_assert(std::atomic<bool>::is_always_lock_free, "used in a signal handler");

void on_hangup(int) {
  if (!hung_up.exchange(true, std::memory_order_relaxed)) on_signal(SIGHUP);
}

bool is_ignored(int signal) {
  struct sigaction action = {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

// SIGPIPE is ignored because every send already checks its result, and a peer that closed its
// socket must not end the process.
void catch_stop_signals(Hangup hangup) {
  struct sigaction action = {};
  action.sa_handler = on_signal;  // no SA_RESTART: a sleeping loop wakes up
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  if (hangup == Hangup::kIgnore) {
    std::signal(SIGHUP, SIG_IGN);
  } else if (!is_ignored(SIGHUP)) {
    action.sa_handler = on_hangup;
    sigaction(SIGHUP, &action, nullptr);
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a write over the limit of file sizes fails as on a full disk
}

int stop_requests() { return requests.load(std::memory_order_relaxed); }

}  // namespace swarm::shell
