// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "swarm_core/app/run_dir.hpp"

namespace swarm::shell {
namespace {

/// Processes that claim a run directory at the same moment, in an empty working directory.
class Claim : public testing::Test {
 protected:
  Claim() {
    folder_ = std::filesystem::temp_directory_path() / ("claim_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~Claim() override { std::filesystem::remove_all(folder_); }

  /// What each of them got: the directory, or "" if it was refused.
  std::vector<std::string> claim_at_once(int processes, const std::string& out) const {
    int gate[2] = {};
    int results[2] = {};
    EXPECT_EQ(::pipe(gate), 0);
    EXPECT_EQ(::pipe(results), 0);
    for (int i = 0; i < processes; ++i) {
      if (::fork() != 0) continue;
      ::close(gate[1]);
      if (::chdir(folder_.c_str()) != 0) ::_exit(1);
      char go = 0;
      // The pipe's end releases all at once; the claim lasts until the parent has read it.
      [[maybe_unused]] const ssize_t read = ::read(gate[0], &go, 1);
      const auto dir = make_run_dir(out, "swarm");
      const std::string line = (dir ? dir->string() : std::string()) + "\n";
      [[maybe_unused]] const ssize_t written = ::write(results[1], line.data(), line.size());
      ::usleep(300'000);
      ::_exit(0);
    }
    ::close(gate[0]);
    ::close(gate[1]);
    ::close(results[1]);
    std::string text;
    char piece[4096];
    for (ssize_t n = 0; (n = ::read(results[0], piece, sizeof piece)) > 0;)
      text.append(piece, static_cast<std::size_t>(n));
    ::close(results[0]);
    while (::waitpid(-1, nullptr, 0) > 0) {
    }
    std::vector<std::string> lines;
    for (std::size_t at = 0, end = 0; (end = text.find('\n', at)) != std::string::npos;
         at = end + 1) {
      lines.push_back(text.substr(at, end - at));
    }
    return lines;
  }

  std::filesystem::path folder_;
};

TEST_F(Claim, GivesEachOfManyProcessesADirectoryOfItsOwn) {
  const auto dirs = claim_at_once(12, "");
  ASSERT_EQ(dirs.size(), 12U);
  const std::set<std::string> different(dirs.begin(), dirs.end());
  EXPECT_EQ(different.size(), 12U);
  EXPECT_EQ(different.count(""), 0U);
}

TEST_F(Claim, GivesANamedDirectoryToOneProcessAtATime) {
  const auto dirs = claim_at_once(6, "named");
  ASSERT_EQ(dirs.size(), 6U);
  EXPECT_EQ(std::count(dirs.begin(), dirs.end(), ""), 5);
}

TEST_F(Claim, EndsWithTheProcess) {
  claim_at_once(1, "named");
  EXPECT_NE(claim_at_once(1, "named").front(), "");
}

}  // namespace
}  // namespace swarm::shell
