// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/stop_signal.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

namespace swarm::shell {
namespace {

/// Restores the signal actions after a test, so that Ctrl-C ends the test program again.
class StopSignals : public testing::Test {
 protected:
  StopSignals() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], nullptr, &before_[i]);
    catch_stop_signals();
  }
  ~StopSignals() override {
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &before_[i], nullptr);
  }

 private:
  static constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ};
  std::array<struct sigaction, kSignals.size()> before_{};
};

TEST_F(StopSignals, AreCountedAndDoNotEndTheProgram) {
  const int before = stop_requests();
  for (const int signal : {SIGINT, SIGTERM, SIGTERM, SIGINT, SIGINT}) ::raise(signal);
  EXPECT_EQ(stop_requests() - before, 5);
}

TEST_F(StopSignals, AreCountedOverTwoInstallations) {
  const int before = stop_requests();
  ::raise(SIGINT);
  catch_stop_signals();
  ::raise(SIGINT);
  EXPECT_EQ(stop_requests() - before, 2);
}

TEST_F(StopSignals, DoNotIncludeAPeerThatClosedItsSocketNorAFullDisk) {
  const int before = stop_requests();
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
  ::close(ends[1]);

  EXPECT_EQ(::write(ends[0], "x", 1), -1);
  EXPECT_EQ(errno, EPIPE);
  ::raise(SIGXFSZ);

  ::close(ends[0]);
  EXPECT_EQ(stop_requests(), before);
}

TEST_F(StopSignals, DoNotIncludeTheEndOfTheTerminalWhereAnotherProcessEndsUs) {
  const int before = stop_requests();
  ::raise(SIGHUP);
  EXPECT_EQ(stop_requests(), before);
}

TEST_F(StopSignals, DoNotIncludeTheEndOfTheTerminalUnderNohup) {
  const int before = stop_requests();
  std::signal(SIGHUP, SIG_IGN);
  catch_stop_signals(Hangup::kStop);
  ::raise(SIGHUP);
  EXPECT_EQ(stop_requests(), before);
}

TEST_F(StopSignals, EndTheProgramAgainOnceReleased) {
  const int before = stop_requests();
  EXPECT_EXIT(
      {
        release_stop_signals();
        ::raise(SIGINT);
      },
      testing::KilledBySignal(SIGINT), "");
  EXPECT_EQ(stop_requests(), before);
}

/// Whether a process that was started with SIGCHLD ignored and stop signals blocked, as by a daemon
/// that does so, notices the end of its child and receives a signal.
bool works_under_a_careless_parent() {
  const int before = stop_requests();
  std::signal(SIGCHLD, SIG_IGN);
  sigset_t all;
  sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, nullptr);

  catch_stop_signals();

  const pid_t child = ::fork();
  if (child == 0) ::_exit(3);
  int status = 0;
  const bool reaped = ::waitpid(child, &status, 0) == child && WEXITSTATUS(status) == 3;
  ::raise(SIGTERM);
  return reaped && stop_requests() - before == 1;
}

TEST(PrepareSignals, TakesBackWhatTheParentIgnoredAndBlocked) {
  EXPECT_EXIT(::_exit(works_under_a_careless_parent() ? 0 : 1), testing::ExitedWithCode(0), "");
}

// The signal is repeated, because the first one may arrive before the thread sleeps.
TEST_F(StopSignals, EndASleep) {
  std::atomic<bool> awake = false;
  int slept = 0;
  std::thread sleeper([&] {
    const timespec day{.tv_sec = 86'400, .tv_nsec = 0};
    slept = ::nanosleep(&day, nullptr);
    awake = true;
  });

  while (!awake) {
    ::pthread_kill(sleeper.native_handle(), SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  sleeper.join();

  EXPECT_EQ(slept, -1) << "it did not sleep to its end";
}

}  // namespace
}  // namespace swarm::shell
