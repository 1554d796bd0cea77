// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/stop_signal.hpp"

#include <atomic>
#include <csignal>

#include <pthread.h>

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

// As they were before they were caught.
struct Before {
  struct sigaction interrupt = {};
  struct sigaction terminate = {};
};
Before before;
bool caught = false;

}  // namespace

// Ignored and blocked signals survive fork() and exec(): a parent that ignores SIGCHLD would keep
// a launcher from noticing that its children end. SIGPIPE is ignored because every send already
// checks its result, and a peer that closed its socket must not end the process.
void prepare_signals() {
  std::signal(SIGCHLD, SIG_DFL);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a write over the limit of file sizes fails as on a full disk
  sigset_t used;
  sigemptyset(&used);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) sigaddset(&used, signal);
  ::pthread_sigmask(SIG_UNBLOCK, &used, nullptr);
}

void catch_stop_signals(Hangup hangup) {
  prepare_signals();
  struct sigaction action = {};
  action.sa_handler = on_signal;  // no SA_RESTART: a sleeping loop wakes up
  sigaction(SIGINT, &action, caught ? nullptr : &before.interrupt);
  sigaction(SIGTERM, &action, caught ? nullptr : &before.terminate);
  caught = true;
  if (hangup == Hangup::kIgnore) {
    std::signal(SIGHUP, SIG_IGN);
  } else if (!is_ignored(SIGHUP)) {
    action.sa_handler = on_hangup;
    sigaction(SIGHUP, &action, nullptr);
  }
}

void release_stop_signals() {
  if (!caught) return;
  sigaction(SIGINT, &before.interrupt, nullptr);
  sigaction(SIGTERM, &before.terminate, nullptr);
}

int stop_requests() { return requests.load(std::memory_order_relaxed); }

}  // namespace swarm::shell
