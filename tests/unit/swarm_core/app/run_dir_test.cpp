// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_dir.hpp"

#include <csignal>
#include <regex>
#include <set>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "swarm_core/app/control_socket.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::shell {
namespace {

namespace fs = std::filesystem;

/// Works in a folder of its own: default run directories are relative to the working directory.
class RunDir : public testing::Test {
 protected:
  RunDir() { fs::current_path(folder_.path()); }
  ~RunDir() override { fs::current_path(before_); }

  fs::path before_ = fs::current_path();
  ScratchFolder folder_;
};

TEST_F(RunDir, IsMadeWithItsFoldersAndNamedByAnAbsolutePath) {
  const auto dir = make_run_dir("a/b/c", "unused");

  ASSERT_TRUE(dir) << dir.error().message;
  EXPECT_TRUE(dir->is_absolute());
  EXPECT_TRUE(fs::equivalent(*dir, folder_ / "a/b/c"));
  EXPECT_TRUE(fs::is_directory(*dir / kLogsFolder));
  EXPECT_TRUE(fs::is_directory(*dir / kRobotLogFolder));
}

TEST_F(RunDir, IsNewForEveryRunThatNamesNone) {
  std::set<fs::path> seen;
  const std::regex name(R"(small-\d{8}-\d{6}(-\d+)?)");
  for (int i = 0; i < 5; ++i) {  // several of them in the same second
    const auto dir = make_run_dir("", "small");
    ASSERT_TRUE(dir) << dir.error().message;
    EXPECT_TRUE(std::regex_match(dir->filename().string(), name)) << dir->filename();
    EXPECT_TRUE(fs::equivalent(dir->parent_path(), folder_ / "runs"));
    EXPECT_TRUE(seen.insert(*dir).second) << *dir << " was given to two runs";
  }
}

TEST_F(RunDir, IsRefusedWhereItHoldsARun) {
  const auto used = fs::absolute("run");
  fs::create_directory(used);
  ASSERT_TRUE(write_run_info(used, {}));

  const auto refused = make_run_dir("run", "x");

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(refused.error().message,
            "--out " + used.string() + ": holds a run already; name another directory");
}

TEST_F(RunDir, KeepsWhatTheDirectoryHolds) {
  fs::create_directory("run");
  folder_.write("run/notes.txt", "mine");
  ASSERT_TRUE(make_run_dir("run", "x"));
  EXPECT_EQ(folder_.read("run/notes.txt"), "mine");
}

TEST_F(RunDir, IsClaimedWithoutTheFoldersOfARun) {
  const auto dir = claim_dir("several", "unused");
  ASSERT_TRUE(dir) << dir.error().message;
  EXPECT_EQ(*dir, folder_ / "several");
  EXPECT_TRUE(fs::is_empty(*dir));
}

TEST_F(RunDir, CannotBeMadeBelowAFile) {
  folder_.write("file", "");
  const auto refused = make_run_dir("file/run", "x");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kEnvironment);
  EXPECT_TRUE(refused.error().message.starts_with("cannot make ")) << refused.error().message;
}

TEST_F(RunDir, IsOfALivingRunUntilItsMakerEnds) {
  EXPECT_FALSE(is_run_alive(folder_ / "nothing"));
  fs::create_directory("run");
  EXPECT_FALSE(is_run_alive(folder_ / "run"));
  const pid_t maker = ::fork();
  ASSERT_GE(maker, 0);
  if (maker == 0) {
    const auto made = make_run_dir("run", "x");
    const auto control = ControlServer::listen("run");  // its socket stays when it is killed
    ::raise(made && control ? SIGSTOP : SIGKILL);
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(maker, &status, WUNTRACED), maker);
  ASSERT_TRUE(WIFSTOPPED(status));
  EXPECT_TRUE(is_run_alive(folder_ / "run")) << "a launcher that is suspended is alive";

  ::kill(maker, SIGKILL);
  ::waitpid(maker, nullptr, 0);

  EXPECT_FALSE(is_run_alive(folder_ / "run"));
}

TEST_F(RunDir, IsOfALivingRunWhereALauncherListens) {
  fs::create_directory("run");
  const auto control = ControlServer::listen("run");
  ASSERT_TRUE(control) << control.error().message;
  EXPECT_TRUE(is_run_alive("run")) << "on a file system without locks";
}

// A checkout that was deleted in another window.
TEST_F(RunDir, NeedsAnAbsoluteNameWhereTheCurrentDirectoryIsGone) {
  fs::create_directory("gone");
  fs::current_path("gone");
  fs::remove(folder_ / "gone");

  for (const char* out : {"", "run"}) {
    const auto refused = make_run_dir(out, "x");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kEnvironment);
    EXPECT_NE(refused.error().message.find("--out"), std::string::npos) << refused.error().message;
  }
  EXPECT_TRUE(make_run_dir(folder_ / "run", "x"));
}

}  // namespace
}  // namespace swarm::shell
