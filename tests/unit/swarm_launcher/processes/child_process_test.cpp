// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/child_process.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::launcher {
namespace {

using Arguments = std::vector<std::string>;

class ChildProcess : public testing::Test {
 protected:
  pid_t start(const Arguments& command_line) {
    const auto pid = start_process(command_line, folder_ / "log");
    EXPECT_TRUE(pid) << pid.error().message;
    return pid.value_or(-1);
  }
  pid_t start_shell(const std::string& script) { return start({"/bin/sh", "-c", script}); }

  /// The next child that ends; waits for it.
  static ExitedChild reap() {
    for (;;) {
      if (const auto child = reap_child()) return *child;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  std::string log() const { return folder_.read("log"); }
  void wait_for_log() const {
    while (log().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  ScratchFolder folder_;
};

TEST_F(ChildProcess, EndsWithTheCodeOfItsProgram) {
  for (const int code : {0, 1, 3, 255}) {
    const pid_t pid = start_shell("exit " + std::to_string(code));
    const ExitedChild child = reap();
    EXPECT_EQ(child.pid, pid);
    EXPECT_EQ(child.exit.code, code);
    EXPECT_EQ(child.exit.signal, 0);
    EXPECT_GT(child.max_rss_mb, 0.0);
    EXPECT_GE(child.cpu_s, 0.0);
  }
}

TEST_F(ChildProcess, EndsByTheSignalThatItIsSent) {
  for (const EndSignal signal : {EndSignal::kInterrupt, EndSignal::kTerminate, EndSignal::kKill}) {
    const pid_t pid = start({"/bin/sleep", "600"});
    ASSERT_EQ(::kill(pid, number_of(signal)), 0);
    const ExitedChild child = reap();
    EXPECT_EQ(child.pid, pid);
    EXPECT_EQ(child.exit.signal, number_of(signal));
  }
}

TEST_F(ChildProcess, IsReapedOnceAndOnlyWhenItHasEnded) {
  EXPECT_FALSE(reap_child()) << "there is none";
  const pid_t pid = start({"/bin/sleep", "600"});
  EXPECT_FALSE(reap_child()) << "it still runs";
  ::kill(pid, SIGKILL);
  EXPECT_EQ(reap().pid, pid);
  EXPECT_FALSE(reap_child());
}

TEST_F(ChildProcess, AppendsBothItsOutputsToTheLog) {
  start_shell("echo one");
  reap();
  start_shell("echo two >&2");
  reap();
  EXPECT_EQ(log(), "one\ntwo\n");
}

TEST_F(ChildProcess, ReceivesItsArgumentsAsTheyAre) {
  start({"/bin/sh", "-c", R"(printf '<%s>' "$@")", "sh", "a b", "", "*", "$HOME", "'\"\\"});
  reap();
  EXPECT_EQ(log(), "<a b><><*><$HOME><'\"\\>");
}

TEST_F(ChildProcess, HasNothingToReadFromItsInput) {
  start({"/bin/cat"});
  EXPECT_EQ(reap().exit.code, 0);
  EXPECT_EQ(log(), "");
}

TEST_F(ChildProcess, LeadsAProcessGroupOfItsOwnAtALowerPriority) {
  const pid_t pid = start_shell("nice; exec sleep 600");
  wait_for_log();

  EXPECT_EQ(::getpgid(pid), pid);
  EXPECT_NE(::getpgid(0), pid);
  EXPECT_EQ(std::stoi(log()), std::min(19, ::getpriority(PRIO_PROCESS, 0) + 5));

  ::kill(pid, SIGKILL);
  reap();
}

TEST_F(ChildProcess, ObeysStopSignalsThatTheLauncherIgnores) {
  const auto before = std::signal(SIGINT, SIG_IGN);
  const pid_t pid = start_shell("kill -INT $$; exit 3");
  const ExitedChild child = reap();
  std::signal(SIGINT, before);

  EXPECT_EQ(child.pid, pid);
  EXPECT_EQ(child.exit.signal, SIGINT);
}

TEST_F(ChildProcess, LeavesTheSignalMaskOfTheLauncherAsItWas) {
  sigset_t before;
  sigset_t after;
  ::pthread_sigmask(SIG_SETMASK, nullptr, &before);
  start_shell("exit 0");
  reap();
  ::pthread_sigmask(SIG_SETMASK, nullptr, &after);
  for (const int signal : {SIGINT, SIGTERM}) {
    EXPECT_EQ(sigismember(&before, signal), sigismember(&after, signal));
  }
}

TEST_F(ChildProcess, OfAProgramThatIsNotThereEndsAsInAShell) {
  start({(folder_ / "none").string()});
  EXPECT_EQ(reap().exit.code, 127);
}

TEST_F(ChildProcess, RunsWithoutItsLogAndReportsThat) {
  std::ofstream(folder_ / "file") << "no folder";
  const auto log = folder_ / "file/log";
  testing::internal::CaptureStderr();
  const auto pid = start_process({"/bin/sh", "-c", "echo lost; exit 3"}, log);
  const std::string reported = testing::internal::GetCapturedStderr();
  ASSERT_TRUE(pid) << pid.error().message;
  EXPECT_EQ(reap().exit.code, 3);
  EXPECT_NE(reported.find("cannot open " + log.string() + ": Not a directory"), std::string::npos)
      << reported;
}

// Descriptors are counted from inside: those of the shell, and the directory that it lists.
TEST_F(ChildProcess, HasNoOtherFilesAndIsTheFirstVictimOfTheOomKiller) {
  const int inherited = ::open("/dev/null", O_RDONLY);  // without O_CLOEXEC, as of a library
  ASSERT_GE(inherited, 0);
  start_shell("cat /proc/self/oom_score_adj; ls /proc/$$/fd | tr '\\n' ' '");
  EXPECT_EQ(reap().exit.code, 0);
  ::close(inherited);
  EXPECT_EQ(log(), "500\n0 1 2 ");
}

// A launcher in between starts a process and dies. The kernel gives the orphan to this test, which
// so learns how it ended.
TEST_F(ChildProcess, IsTerminatedWhenItsLauncherDies) {
  ASSERT_EQ(::prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
  const pid_t launcher = ::fork();
  if (launcher == 0) {
    start_shell("echo up; exec sleep 600");
    wait_for_log();
    ::_exit(0);
  }
  ASSERT_GT(launcher, 0);

  const ExitedChild first = reap();
  const ExitedChild second = reap();
  ::prctl(PR_SET_CHILD_SUBREAPER, 0);

  EXPECT_EQ(first.pid, launcher);
  EXPECT_EQ(second.exit.signal, SIGTERM);
}

TEST(SiblingProgram, LiesBesideTheRunningOneUnlessAnotherIsChosen) {
  const auto own = std::filesystem::read_symlink("/proc/self/exe");
  EXPECT_EQ(sibling_program(own.filename().string()), own);
  EXPECT_EQ(program_or("", "robot_agent"), own.parent_path() / "robot_agent");
  EXPECT_EQ(program_or("/opt/mine", "robot_agent"), "/opt/mine");
}

}  // namespace
}  // namespace swarm::launcher
