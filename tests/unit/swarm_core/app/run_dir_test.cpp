// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_dir.hpp"

#include <regex>
#include <set>

#include <gtest/gtest.h>

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

TEST_F(RunDir, CannotBeMadeBelowAFile) {
  folder_.write("file", "");
  const auto refused = make_run_dir("file/run", "x");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kEnvironment);
  EXPECT_TRUE(refused.error().message.starts_with("cannot make ")) << refused.error().message;
}

}  // namespace
}  // namespace swarm::shell
