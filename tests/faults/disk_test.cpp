// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The disk of a run fills, becomes read-only, stops answering or is removed, and the planner dies.
// Needs root, for file systems of its own.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include <sys/mount.h>
#include <unistd.h>

#include "swarm_core/robot_log/robot_log_file.hpp"
#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

bool execute(const std::string& command) { return std::system(command.c_str()) == 0; }

/// A file system in a folder of its own, for as long as this object exists.
class OwnDisk {
 public:
  enum class Kind : std::uint8_t { kMemory, kExt4 };

  explicit OwnDisk(Kind kind) {
    std::filesystem::create_directory(path());
    if (kind == Kind::kMemory) {
      is_mounted_ = ::mount("tmpfs", path().c_str(), "tmpfs", 0, "size=6m") == 0;
      return;
    }
    const std::string image = (folder_.path() / "image").string();
    is_mounted_ = execute("truncate -s 32M " + image + " && mkfs.ext4 -q -F " + image +
                          " >/dev/null 2>&1 && mount -o loop,errors=remount-ro " + image + " " +
                          path().string() + " 2>/dev/null");
  }
  ~OwnDisk() {
    if (is_mounted_) ::umount2(path().c_str(), MNT_DETACH);
  }
  OwnDisk(const OwnDisk&) = delete;
  OwnDisk& operator=(const OwnDisk&) = delete;

  bool is_mounted() const { return is_mounted_; }
  std::filesystem::path path() const { return folder_.path() / "disk"; }

  void fill() const {
    std::ofstream out(path() / "filler", std::ios::binary);
    const std::string block(4096, 'x');
    while (out.write(block.data(), static_cast<std::streamsize>(block.size())).flush()) {
    }
  }
  /// As the kernel does after an error of the device.
  bool make_read_only() const {
    return execute("echo 1 >/sys/fs/ext4/$(basename $(findmnt -n -o SOURCE " + path().string() +
                   "))/trigger_fs_error");
  }

 private:
  TemporaryFolder folder_;
  bool is_mounted_ = false;
};

class DiskFault : public testing::TestWithParam<const char*> {
 protected:
  /// False if this machine does not let us have the disk.
  bool begin(OwnDisk::Kind kind) {
    disk_ = std::make_unique<OwnDisk>(kind);
    if (!disk_->is_mounted()) return false;
    launcher_ = std::make_unique<Program>(
        "swarm_launcher", std::vector<std::string>{"run", kSmallMission, "--channel", GetParam(),
                                                   "--out", dir().string()});
    return true;
  }
  std::filesystem::path dir() const { return disk_->path() / "run"; }
  bool mission_started() const {
    return eventually([this] { return has_event(dir(), "command"); });
  }
  /// Kills the planner; a new one is started although the disk fails.
  void expect_new_planner_after_a_kill() const {
    const auto killed = planners();
    ASSERT_EQ(killed.size(), 1U);
    ::kill(killed.front(), SIGKILL);
    EXPECT_TRUE(eventually([&] {
      const auto now = planners();
      return now.size() == 1 && now.front() != killed.front();
    }));
  }
  /// The launcher itself has received all robots at their goals.
  void expect_that_all_arrived() const {
    EXPECT_NE(launcher_->out().find("mission          completed"), std::string::npos)
        << launcher_->out() << launcher_->err();
    EXPECT_EQ(launcher_->err().find("agent process "), std::string::npos) << launcher_->err();
  }

  /// As above, though the run is not ok: the launcher names what is missing, and `cause`.
  void expect_arrival_with_missing_records(const std::string& cause) {
    EXPECT_EQ(launcher_->wait(), 1) << launcher_->err();
    expect_that_all_arrived();
    EXPECT_NE(launcher_->out().find("missing"), std::string::npos) << launcher_->out();
    EXPECT_NE(launcher_->err().find(cause), std::string::npos) << launcher_->err();
  }

  std::unique_ptr<OwnDisk> disk_;
  std::unique_ptr<Program> launcher_;

 private:
  std::vector<pid_t> planners() const { return children_of(launcher_->pid(), "planner_service"); }
};

#define BEGIN_OR_SKIP(kind) \
  if (!begin(OwnDisk::Kind::kind)) GTEST_SKIP() << "needs root and a file system of its own"

TEST_P(DiskFault, FullAllArriveAndWhatIsMissingIsNamed) {
  BEGIN_OR_SKIP(kMemory);
  ASSERT_TRUE(mission_started());
  disk_->fill();
  expect_new_planner_after_a_kill();

  expect_arrival_with_missing_records("No space left on device");
}

// The records of the full minute wait in memory.
TEST_P(DiskFault, FullForAWhileNothingIsMissing) {
  BEGIN_OR_SKIP(kMemory);
  ASSERT_TRUE(mission_started());
  disk_->fill();
  expect_new_planner_after_a_kill();
  std::this_thread::sleep_for(std::chrono::seconds(5));
  std::filesystem::remove(disk_->path() / "filler");

  EXPECT_EQ(launcher_->wait(), 0) << launcher_->err() << launcher_->out();

  expect_that_all_arrived();
  EXPECT_TRUE(has_event(dir(), "disk-fails"));
  EXPECT_TRUE(has_event(dir(), "disk-works"));
  EXPECT_TRUE(has_event(dir(), "respawn")) << "written when there was room again";
}

TEST_P(DiskFault, ReadOnlyAllArriveAndWhatIsMissingIsNamed) {
  BEGIN_OR_SKIP(kExt4);
  ASSERT_TRUE(mission_started());
  if (!disk_->make_read_only()) GTEST_SKIP() << "the kernel has no such switch";
  expect_new_planner_after_a_kill();

  expect_arrival_with_missing_records("Read-only file system");
}

TEST_P(DiskFault, RemovedAllArriveAndTheRestIsWrittenAgain) {
  BEGIN_OR_SKIP(kMemory);
  ASSERT_TRUE(mission_started());
  std::filesystem::rename(dir(), disk_->path() / "removed");  // before its files are made again
  std::filesystem::remove_all(disk_->path() / "removed");
  expect_new_planner_after_a_kill();

  EXPECT_EQ(launcher_->wait(), 1) << launcher_->err();

  expect_that_all_arrived();
  EXPECT_NE(launcher_->out().find("removed"), std::string::npos) << launcher_->out();
  EXPECT_TRUE(std::filesystem::exists(dir() / "summary.json"));
  Program audit("swarm_monitor", {"audit", dir().string()});
  EXPECT_EQ(audit.wait(), 1);
  EXPECT_NE(audit.out().find("missing"), std::string::npos) << audit.out();
}

/// Longest time between two steps of a robot.
Duration longest_gap(const std::filesystem::path& run_dir, std::uint32_t robot) {
  Duration longest{};
  std::optional<UtcTime> last;
  const auto read = robot_log::read_records(
      robot_log::file_of(run_dir, RobotId(robot)), [&](const robot_log::Record& record) {
        const auto* step = std::get_if<robot_log::Step>(&record);
        if (step == nullptr) return;
        if (last) longest = std::max(longest, step->stamp - *last);
        last = step->stamp;
      });
  EXPECT_TRUE(read) << read.error().message;
  EXPECT_EQ(read ? read->lost : 0U, 0U);
  return longest;
}

TEST_P(DiskFault, FrozenRobotsFlyOnAndNothingIsMissing) {
  BEGIN_OR_SKIP(kExt4);
  ASSERT_TRUE(mission_started());
  constexpr std::chrono::seconds kFrozen{12};
  const auto thaw_at = std::chrono::steady_clock::now() + kFrozen;
  if (!execute("fsfreeze -f " + disk_->path().string())) GTEST_SKIP() << "cannot freeze";
  expect_new_planner_after_a_kill();
  const bool restarted_in_time = std::chrono::steady_clock::now() < thaw_at;
  std::this_thread::sleep_until(thaw_at);
  ASSERT_TRUE(execute("fsfreeze -u " + disk_->path().string()));
  EXPECT_TRUE(restarted_in_time);

  EXPECT_EQ(launcher_->wait(), 0) << launcher_->err() << launcher_->out();

  expect_that_all_arrived();
  EXPECT_TRUE(has_event(dir(), "disk-fails"));
  for (std::uint32_t robot = 0; robot < 12; ++robot) {
    EXPECT_LT(longest_gap(dir(), robot), kFrozen / 2) << robot;
  }
}

INSTANTIATE_TEST_SUITE_P(Channels, DiskFault, testing::Values("topics", "groups"),
                         [](const auto& channel) { return std::string(channel.param); });

}  // namespace
}  // namespace swarm::test
