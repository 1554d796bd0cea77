// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The user stops the output of the launcher's terminal (Ctrl-S).
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include <fcntl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

/// `swarm_launcher run` at a terminal of its own.
class LauncherAtTerminal {
 public:
  explicit LauncherAtTerminal(const std::filesystem::path& dir) {
    master_ = ::posix_openpt(O_RDWR | O_NOCTTY);
    ::grantpt(master_);
    ::unlockpt(master_);
    slave_ = ::open(::ptsname(master_), O_RDWR | O_NOCTTY);
    reader_ = std::thread([this] {
      char text[256];
      while (::read(master_, text, sizeof text) > 0) {
      }
    });
    const std::string program = std::string(SWARM_BIN_DIR) + "/swarm_launcher";
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(slave_, STDOUT_FILENO);
      ::dup2(slave_, STDERR_FILENO);
      ::execl(program.c_str(), program.c_str(), "run", kSmallMission.c_str(), "--out", dir.c_str(),
              static_cast<char*>(nullptr));
      ::_exit(127);
    }
  }
  ~LauncherAtTerminal() {
    ::tcflow(slave_, TCOON);
    if (!ended_) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
    ::close(slave_);  // the reader sees the end
    reader_.join();
    ::close(master_);
  }
  LauncherAtTerminal(const LauncherAtTerminal&) = delete;
  LauncherAtTerminal& operator=(const LauncherAtTerminal&) = delete;

  void press_ctrl_s() const { ASSERT_EQ(::tcflow(slave_, TCOOFF), 0); }
  void press_ctrl_q() const { ASSERT_EQ(::tcflow(slave_, TCOON), 0); }
  pid_t pid() const { return pid_; }
  /// Exit code; -1 at the end of the time limit.
  int wait() {
    int status = 0;
    ended_ = eventually([&] { return ::waitpid(pid_, &status, WNOHANG) == pid_; });
    return ended_ && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  int master_ = -1;
  int slave_ = -1;
  pid_t pid_ = -1;
  bool ended_ = false;
  std::thread reader_;
};

TEST(StoppedTerminal, DelaysNeitherTheFlightNorAStop) {
  TemporaryFolder folder;
  const auto dir = folder.path() / "run";
  LauncherAtTerminal launcher(dir);
  ASSERT_TRUE(eventually([&] { return has_event(dir, "command"); }));
  launcher.press_ctrl_s();
  std::this_thread::sleep_for(std::chrono::seconds(3));  // many updates of the live line
  Program pause("swarm_launcher", {"command", dir.string(), "pause"});
  EXPECT_EQ(pause.wait(), 0) << pause.out() << pause.err();

  Program stop("swarm_launcher", {"command", dir.string(), "stop"});

  EXPECT_EQ(stop.wait(), 0) << stop.out() << stop.err();
  EXPECT_NE(stop.out().find("12 robots"), std::string::npos) << stop.out();
  EXPECT_TRUE(eventually([&] { return children_of(launcher.pid()).empty(); }))
      << "the run ends while the terminal is stopped";
  launcher.press_ctrl_q();
  EXPECT_EQ(launcher.wait(), 1) << "the robots did not arrive";
}

}  // namespace
}  // namespace swarm::test
