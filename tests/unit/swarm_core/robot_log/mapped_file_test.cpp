// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/robot_log/mapped_file.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

namespace swarm::mcap {
namespace {

/// A folder of the test's own.
class MappedFileTest : public testing::Test {
 protected:
  MappedFileTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("mapped_file_test_" + std::to_string(::getpid()) + "_" +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder_);
  }
  ~MappedFileTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::filesystem::path write(const std::string& text) const {
    std::ofstream(folder_ / "file", std::ios::binary) << text;
    return folder_ / "file";
  }
  static std::string text_of(const MappedFile& file) {
    return {file.bytes().begin(), file.bytes().end()};
  }
  static std::string error_of(const std::filesystem::path& path) {
    const auto file = MappedFile::open(path);
    if (file) return "";
    EXPECT_EQ(file.error().code, ErrorCode::kEnvironment);
    return file.error().message;
  }

  std::filesystem::path folder_;
};

TEST_F(MappedFileTest, HasAllBytesOfTheFile) {
  for (const std::size_t size : {std::size_t{1}, std::size_t{4096}, std::size_t{10'000}}) {
    std::string text(size, 'a');
    text.back() = '\0';
    const auto file = MappedFile::open(write(text));

    ASSERT_TRUE(file.has_value()) << file.error().message;
    EXPECT_EQ(text_of(*file), text);
  }
}

TEST_F(MappedFileTest, OfAnEmptyFileHasNone) {
  const auto file = MappedFile::open(write(""));

  ASSERT_TRUE(file.has_value()) << file.error().message;
  EXPECT_TRUE(file->bytes().empty());
}

TEST_F(MappedFileTest, OutlivesTheNameOfTheFile) {
  const auto path = write("still there");
  const auto file = MappedFile::open(path);
  std::filesystem::remove(path);

  ASSERT_TRUE(file.has_value());
  EXPECT_EQ(text_of(*file), "still there");
}

TEST_F(MappedFileTest, IsMovedWithItsBytes) {
  auto first = MappedFile::open(write("first"));
  ASSERT_TRUE(first.has_value());
  const unsigned char* data = first->bytes().data();
  MappedFile second = std::move(*first);
  EXPECT_EQ(second.bytes().data(), data);
  EXPECT_TRUE(first->bytes().empty());
  std::filesystem::remove(folder_ / "file");

  auto other = MappedFile::open(write("other"));
  ASSERT_TRUE(other.has_value());
  second = std::move(*other);

  EXPECT_EQ(text_of(second), "other");
}

TEST_F(MappedFileTest, IsRefusedWhereThereIsNoFile) {
  EXPECT_EQ(error_of(folder_ / "none"),
            (folder_ / "none").string() + ": cannot be opened: No such file or directory");
  EXPECT_EQ(error_of(folder_), folder_.string() + ": is no file");
}

// A pipe without a writer would block the program for ever.
TEST_F(MappedFileTest, IsRefusedForAPipeWithoutWaitingForItsWriter) {
  const auto pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);

  EXPECT_EQ(error_of(pipe), pipe.string() + ": is no file");
}

}  // namespace
}  // namespace swarm::mcap
