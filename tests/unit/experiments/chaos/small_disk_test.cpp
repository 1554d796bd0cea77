// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/small_disk.hpp"

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <unistd.h>

namespace swarm::launcher {
namespace {

namespace fs = std::filesystem;

/// In a folder that is removed at the end. Needs root.
class SmallDiskTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto mounts = own_mounts(); !mounts) GTEST_SKIP() << mounts.error().message;
    auto made = SmallDisk::make(folder(), 4U << 20U);
    ASSERT_TRUE(made) << made.error().message;
    disk_ = *std::move(made);
  }
  void TearDown() override {
    disk_.reset();
    fs::remove_all(folder());
  }
  static fs::path folder() {
    return fs::temp_directory_path() / ("swarmflow-disk-" + std::to_string(::getpid()));
  }
  static bool write(const std::string& name, std::size_t bytes) {
    std::ofstream out(folder() / name);
    return static_cast<bool>(out << std::string(bytes, 'x') << std::flush);
  }

  std::unique_ptr<SmallDisk> disk_;
};

TEST_F(SmallDiskTest, TakesNothingWhileItIsFull) {
  EXPECT_TRUE(write("before", 100));

  EXPECT_TRUE(disk_->fill());

  EXPECT_FALSE(write("meanwhile", 8192));
  EXPECT_FALSE(disk_->fill()) << "it is full already";
  disk_->free();
  EXPECT_TRUE(write("after", 8192));
  EXPECT_TRUE(disk_->fill()) << "again";
}

TEST_F(SmallDiskTest, LeavesItsContentBehind) {
  fs::create_directories(folder() / "logs");
  ASSERT_TRUE(write("logs/agent", 100));
  ASSERT_TRUE(disk_->fill());

  disk_.reset();

  EXPECT_EQ(fs::file_size(folder() / "logs/agent"), 100U);
  EXPECT_FALSE(fs::exists(folder() / "filler"));
  EXPECT_TRUE(write("more", 8U << 20U)) << "on the disk around it, which is larger";
}

}  // namespace
}  // namespace swarm::launcher
