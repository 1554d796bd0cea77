// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/file_thread.hpp"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/swarm_core/app/scratch_folder.hpp"
#include "tests/unit/swarm_core/files/fake_disk.hpp"

namespace {

// Of the thread that counts. operator delete is not inlined, as g++ then takes free() for the wrong
// partner of new.
thread_local std::size_t allocations = 0;

}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace swarm::shell {
namespace {

using files::bytes_of;
using files::FakeDisk;
using std::chrono::milliseconds;
using std::chrono::seconds;

const std::filesystem::path kA = "/run/a", kB = "/run/b";
constexpr Duration kLong = seconds(60);

/// The test's disk, which may go on after the FileThread has given it up.
class SharedDisk final : public files::Disk {
 public:
  explicit SharedDisk(std::shared_ptr<files::Disk> disk) : disk_(std::move(disk)) {}
  Answer<int> open(const std::filesystem::path& file) override { return disk_->open(file); }
  Answer<State> state(int fd) override { return disk_->state(fd); }
  Answer<std::size_t> write(int fd, std::span<const unsigned char> bytes) override {
    std::this_thread::sleep_for(delay);
    return disk_->write(fd, bytes);
  }
  Answer<std::size_t> read_at(int fd, std::uint64_t at, std::span<unsigned char> bytes) override {
    return disk_->read_at(fd, at, bytes);
  }
  int truncate(int fd, std::uint64_t size) override { return disk_->truncate(fd, size); }
  void close(int fd) override { disk_->close(fd); }
  int replace(const std::filesystem::path& file, std::string_view content) override {
    return disk_->replace(file, content);
  }
  int remove(const std::filesystem::path& file) override { return disk_->remove(file); }
  bool exists(const std::filesystem::path& file) override { return disk_->exists(file); }

  Duration delay{};

 private:
  std::shared_ptr<files::Disk> disk_;
};

class FileThreadTest : public testing::Test {
 protected:
  AppendStream lines(const std::filesystem::path& file, std::size_t capacity = 4096,
                     Flush flush = Flush::kAtOnce) {
    return sut_->append_to(files::lines_of(file), flush, capacity);
  }
  FileHealth health(Duration later = {}) const {
    return sut_->health(std::chrono::steady_clock::now() + later);
  }
  template <class Condition>
  bool eventually(Condition condition) {
    for (int i = 0; i < 6000 && !condition(); ++i) std::this_thread::sleep_for(milliseconds(10));
    return condition();
  }

  std::shared_ptr<FakeDisk> disk_ = std::make_shared<FakeDisk>();
  std::unique_ptr<FileThread> sut_ =
      std::make_unique<FileThread>(std::make_unique<SharedDisk>(disk_));
};

TEST_F(FileThreadTest, WritesTheRecordsOfEachFileInTheirOrder) {
  AppendStream a = lines(kA), b = lines(kB, 4096, Flush::kLazily);
  for (const char* line : {"1\n", "2\n", "3\n"}) {
    EXPECT_TRUE(a.push(line));
    EXPECT_TRUE(b.push(line));
  }
  EXPECT_TRUE(sut_->flush(kLong));
  EXPECT_EQ(disk_->content(kA), "1\n2\n3\n");
  EXPECT_EQ(disk_->content(kB), "1\n2\n3\n");
  EXPECT_EQ(health().failing + health().lost, 0U);
}

TEST_F(FileThreadTest, WritesWithoutBeingAsked) {
  AppendStream a = lines(kA), b = lines(kB, 4096, Flush::kLazily);
  a.push("1\n");
  b.push("2\n");
  EXPECT_TRUE(eventually([&] { return disk_->content(kA) == "1\n"; }));
  EXPECT_TRUE(eventually([&] { return disk_->content(kB) == "2\n"; }));
}

// The control loop pushes: it must neither wait for the disk nor allocate.
TEST_F(FileThreadTest, TakesRecordsWhileTheDiskDoesNotAnswerWithoutAllocating) {
  AppendStream a = lines(kA);
  disk_->freeze();
  a.push("first\n");
  disk_->wait_for_a_write();

  const std::size_t before = allocations;
  std::uint64_t taken = 0;
  for (int i = 0; i < 1000; ++i) taken += a.push("0123456\n") ? 1 : 0;
  EXPECT_EQ(allocations - before, 0U);

  EXPECT_GT(taken, 100U);
  EXPECT_EQ(a.dropped(), 1000 - taken);
  EXPECT_EQ(health().lost, 1000 - taken);
  EXPECT_EQ(health().failing, 0U) << "a moment is no fault";
  EXPECT_EQ(health(seconds(2)).failing, 1U);
  EXPECT_EQ(health(seconds(2)).error, 0);
  EXPECT_EQ(health(seconds(2)).first, kA);

  disk_->thaw();
  EXPECT_TRUE(sut_->flush(kLong));
  std::string expected = "first\n";
  for (std::uint64_t i = 0; i < taken; ++i) expected += "0123456\n";
  EXPECT_EQ(disk_->content(kA), expected);
  EXPECT_EQ(health(seconds(2)).failing, 0U);
  const auto losses = sut_->finish();
  ASSERT_EQ(losses.size(), 1U);
  EXPECT_EQ(losses[0].file, kA);
  EXPECT_EQ(losses[0].records, 1000 - taken);
}

TEST_F(FileThreadTest, RecoversFromAFullDiskWithoutALoss) {
  AppendStream a = lines(kA);
  disk_->fill(5);
  a.push("123\n");
  a.push("456\n");
  EXPECT_TRUE(eventually([&] { return health().failing == 1; }));
  EXPECT_EQ(health().error, ENOSPC);
  a.push("789\n");
  disk_->fill(UINT64_MAX);
  EXPECT_TRUE(eventually([&] { return disk_->content(kA) == "123\n456\n789\n"; }));
  EXPECT_TRUE(eventually([&] { return health().failing == 0; }));
  EXPECT_TRUE(sut_->finish().empty());
}

TEST_F(FileThreadTest, WritesOtherFilesWhileOneCannotBeWritten) {
  const ScratchFolder folder;
  FileThread sut;
  AppendStream full = sut.append_to({.file = "/dev/full"}, Flush::kAtOnce, 4096);
  AppendStream good = sut.append_to({.file = folder / "good"}, Flush::kAtOnce, 4096);
  full.push("lost");
  good.push("kept");
  sut.replace(folder / "whole", "kept");
  EXPECT_TRUE(eventually([&] { return folder.read("good") == "kept"; }));
  EXPECT_TRUE(eventually([&] { return folder.read("whole") == "kept"; }));
  const auto losses = sut.finish(milliseconds(300));
  ASSERT_EQ(losses.size(), 1U);
  EXPECT_EQ(losses[0].file, "/dev/full");
  EXPECT_EQ(losses[0].records, 1U);
  EXPECT_EQ(losses[0].error, ENOSPC);
  EXPECT_EQ(describe(losses[0]), "full: 1 record (No space left on device)");
}

TEST_F(FileThreadTest, WritesTheNewestContentOfAWholeFile) {
  disk_->freeze();
  sut_->replace(kA, "1");
  disk_->wait_for_a_write();
  sut_->replace(kA, "2");
  sut_->replace(kA, "3");
  sut_->replace(kB, "4");
  sut_->remove(kB);
  disk_->thaw();
  EXPECT_TRUE(sut_->flush(kLong));
  EXPECT_EQ(disk_->content(kA), "3");
  EXPECT_FALSE(disk_->has(kB));
}

TEST_F(FileThreadTest, RepeatsAWholeFileThatCouldNotBeWritten) {
  disk_->fill(0);
  sut_->replace(kA, "text");
  EXPECT_TRUE(eventually([&] { return health().failing == 1; }));
  EXPECT_EQ(health().first, kA);
  EXPECT_EQ(health().error, ENOSPC);
  disk_->fill(UINT64_MAX);
  EXPECT_TRUE(eventually([&] { return disk_->content(kA) == "text"; }));
  EXPECT_TRUE(eventually([&] { return health().failing == 0; }));
}

TEST_F(FileThreadTest, MakesFilesAgainThatOthersRemoved) {
  AppendStream a = lines(kA);
  sut_->keep(kB, "kept");
  a.push("1\n");
  EXPECT_TRUE(sut_->flush(kLong));
  disk_->unlink(kA);
  disk_->unlink(kB);
  a.push("2\n");
  EXPECT_TRUE(eventually([&] { return disk_->content(kA) == "2\n"; }));
  EXPECT_TRUE(eventually([&] { return disk_->content(kB) == "kept"; }));
  EXPECT_EQ(health().removed, 1U);
  const auto losses = sut_->finish();
  ASSERT_EQ(losses.size(), 1U);
  EXPECT_EQ(describe(losses[0]), "a: what it held before it was removed");
}

TEST_F(FileThreadTest, FinishesFilesWithTheirEnds) {
  AppendStream a = sut_->append_to({.file = kA, .end = files::to_bytes("end")}, Flush::kLazily, 64);
  a.push("1\n");
  EXPECT_TRUE(sut_->finish().empty());
  EXPECT_EQ(disk_->content(kA), "1\nend");
}

TEST_F(FileThreadTest, GivesUpADiskThatTakesNothingAndCountsWhatIsMissing) {
  AppendStream a = lines(kA);
  disk_->fill(0);
  a.push("1\n");
  a.push("2\n");
  sut_->replace(kB, "whole");
  const auto losses = sut_->finish(milliseconds(300));
  ASSERT_EQ(losses.size(), 2U);
  EXPECT_EQ(describe(losses[0]), "a: 2 records (No space left on device)");
  EXPECT_EQ(describe(losses[1]), "b: all of it (No space left on device)");
}

TEST_F(FileThreadTest, GivesUpADiskThatDoesNotAnswer) {
  AppendStream a = lines(kA);
  disk_->freeze();
  a.push("1\n");
  disk_->wait_for_a_write();
  a.push("2\n");
  const auto losses = sut_->finish(milliseconds(300));
  ASSERT_EQ(losses.size(), 1U);
  EXPECT_EQ(losses[0].records, 2U);
  EXPECT_EQ(losses[0].error, 0);
  sut_.reset();
  disk_->thaw();  // its thread ends by itself
}

// The disk takes longer than the limit for all, but not for one piece.
TEST_F(FileThreadTest, WaitsForASlowDiskThatMakesProgress) {
  auto slow = std::make_unique<SharedDisk>(disk_);
  slow->delay = milliseconds(150);
  FileThread sut(std::move(slow));
  AppendStream a = sut.append_to({.file = kA}, Flush::kLazily, 256U << 10U);
  for (int i = 0; i < 24; ++i) EXPECT_TRUE(a.push(std::string(7000, 'x')));
  EXPECT_TRUE(sut.finish(seconds(3)).empty());
  EXPECT_EQ(disk_->content(kA).size(), 24U * 7000U);
}

TEST_F(FileThreadTest, LosesTheNewestWholeFilesBeyondItsLimit) {
  disk_->freeze();
  sut_->replace(kA, std::string(40U << 20U, 'a'));
  sut_->replace(kB, std::string(40U << 20U, 'b'));
  EXPECT_EQ(health().lost, 1U);
  disk_->thaw();
  const auto losses = sut_->finish();
  ASSERT_EQ(losses.size(), 1U);
  EXPECT_EQ(losses[0].file, kB);
  EXPECT_EQ(disk_->content(kA).size(), 40U << 20U);
}

}  // namespace
}  // namespace swarm::shell
