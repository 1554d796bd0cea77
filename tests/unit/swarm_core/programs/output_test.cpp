// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/output.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <functional>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "swarm_core/app/program.hpp"
#include "swarm_core/app/stop_signal.hpp"

namespace swarm::shell {
namespace {

/// The exit code of a program with this body, after `prepare` has changed its standard streams.
int exit_code_of(const std::function<void()>& prepare, const std::function<ExitCode()>& body) {
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child == 0) {
    prepare();
    std::clearerr(stdout);
    ::_exit(run_main("program", [&]() -> Result<ExitCode> {
      catch_stop_signals();
      return body();
    }));
  }
  int status = 0;
  if (::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

void to_full_disk() { ::dup2(::open("/dev/full", O_WRONLY), STDOUT_FILENO); }

void to_pipe_without_reader() {
  int ends[2] = {};
  if (::pipe(ends) != 0) ::_exit(99);
  ::dup2(ends[1], STDOUT_FILENO);
  ::close(ends[0]);
  ::close(ends[1]);
}

ExitCode print_little() {
  std::puts("a result");
  return ExitCode::kOk;
}

ExitCode print_much() {
  for (int i = 0; i < 100'000 && output_works(); ++i) std::puts("a line of a long result");
  return output_works() ? ExitCode::kCriteriaNotMet : ExitCode::kOk;  // it is to notice
}

constexpr int kLost = static_cast<int>(ExitCode::kEnvironment);

TEST(Output, ThatIsLostIsNoSuccess) {
  EXPECT_EQ(exit_code_of(to_full_disk, print_little), kLost);
  EXPECT_EQ(exit_code_of(to_full_disk, print_much), kLost);
  EXPECT_EQ(exit_code_of([] { ::close(STDOUT_FILENO); }, print_little), kLost);
}

TEST(Output, ThatIsLostKeepsTheExitCodeOfAnotherFailure) {
  EXPECT_EQ(exit_code_of(to_full_disk,
                         [] {
                           std::puts("a result");
                           return ExitCode::kCriteriaNotMet;
                         }),
            static_cast<int>(ExitCode::kCriteriaNotMet));
}

TEST(Output, MayEndWhereItsReaderHasEnough) {
  EXPECT_EQ(exit_code_of(to_pipe_without_reader, print_little), 0);
  EXPECT_EQ(exit_code_of(to_pipe_without_reader, print_much), 0);
}

TEST(Output, MayBeEmptyOnAFullDisk) {
  EXPECT_EQ(exit_code_of(to_full_disk, [] { return ExitCode::kOk; }), 0);
}

// A file that is opened must not get the number of a closed standard stream.
TEST(Output, IsNotMixedIntoFiles) {
  const auto close_all = [] {
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) ::close(fd);
  };
  EXPECT_EQ(exit_code_of(close_all,
                         [] {
                           const int fd = ::open("/dev/null", O_WRONLY);
                           return fd > STDERR_FILENO ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
                         }),
            0);
}

/// The stop signals that a process counts after two hangups: kernel and shell send one each.
int stops_after_hangup(Hangup hangup, void (*before)(int)) {
  return exit_code_of([] {},
                      [hangup, before] {
                        std::signal(SIGHUP, before);
                        catch_stop_signals(hangup);
                        ::raise(SIGHUP);
                        ::raise(SIGHUP);
                        return static_cast<ExitCode>(stop_requests());
                      });
}

TEST(Hangup, EndsAProgramOnceUnlessItIsToOutliveItsTerminal) {
  EXPECT_EQ(stops_after_hangup(Hangup::kStop, SIG_DFL), 1);
  EXPECT_EQ(stops_after_hangup(Hangup::kStop, SIG_IGN), 0) << "as nohup starts it";
  EXPECT_EQ(stops_after_hangup(Hangup::kIgnore, SIG_DFL), 0);
}

}  // namespace
}  // namespace swarm::shell
