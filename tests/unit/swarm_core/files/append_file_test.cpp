// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/files/append_file.hpp"

#include <cerrno>
#include <string>

#include <gtest/gtest.h>

#include "swarm_core/files/disk.hpp"
#include "tests/unit/swarm_core/app/scratch_folder.hpp"
#include "tests/unit/swarm_core/files/fake_disk.hpp"

namespace swarm::files {
namespace {

const std::filesystem::path kFile = "/run/file";

AppendFormat a_format() {
  return {.file = kFile, .preamble = to_bytes("<"), .begin = to_bytes("("), .end = to_bytes(">")};
}

int append(AppendFile& file, Disk& disk, std::string_view text) {
  return file.append(disk, bytes_of(text));
}

TEST(AppendFile, WritesPreambleBeginRecordsAndEnd) {
  FakeDisk disk;
  AppendFile sut(a_format());
  EXPECT_EQ(append(sut, disk, "a"), 0);
  EXPECT_EQ(append(sut, disk, "b"), 0);
  EXPECT_EQ(sut.finish(disk), 0);
  EXPECT_EQ(disk.content(kFile), "<(ab>");
  EXPECT_EQ(disk.closed, 1);
}

TEST(AppendFile, GoesOnBehindAnEarlierWriterInsteadOfItsEnd) {
  FakeDisk disk;
  for (const char* record : {"a", "b"}) {
    AppendFile sut(a_format());
    EXPECT_EQ(append(sut, disk, record), 0);
    EXPECT_EQ(sut.finish(disk), 0);
  }
  EXPECT_EQ(disk.content(kFile), "<(a(b>");
}

TEST(AppendFile, SeparatesARecordOfAKilledWriterFromTheNext) {
  FakeDisk disk;
  disk.set_content("/run/lines", "whole\nhal");
  AppendFile sut(lines_of("/run/lines"));
  EXPECT_EQ(append(sut, disk, "next\n"), 0);
  EXPECT_EQ(disk.content("/run/lines"), "whole\nhal\nnext\n");
}

// For every number of bytes that fit: the file holds whole records, and the repetition of the one
// that did not fit makes it complete.
TEST(AppendFile, KeepsWholeRecordsOnAFullDisk) {
  const std::string records[] = {"first", "second", "third"};
  for (std::uint64_t room = 0; room < 20; ++room) {
    FakeDisk disk;
    disk.room_bytes = room;
    disk.most_at_once = 2;
    AppendFile sut(a_format());
    std::string expected;
    std::size_t next = 0;
    for (; next < 3 && append(sut, disk, records[next]) == 0; ++next) {
      expected += (next == 0 ? "<(" : "") + records[next];
    }
    EXPECT_EQ(disk.content(kFile), expected) << room;
    disk.room_bytes = UINT64_MAX;
    for (; next < 3; ++next) EXPECT_EQ(append(sut, disk, records[next]), 0);
    EXPECT_EQ(disk.content(kFile), "<(firstsecondthird") << room;
  }
}

TEST(AppendFile, MarksATornRecordThatCannotBeRemoved) {
  FakeDisk disk;
  AppendFile sut(lines_of(kFile));
  EXPECT_EQ(append(sut, disk, "first\n"), 0);
  disk.room_bytes = 3;
  disk.truncate_error = EIO;
  EXPECT_EQ(append(sut, disk, "second\n"), ENOSPC);
  disk.room_bytes = UINT64_MAX;
  EXPECT_EQ(append(sut, disk, "second\n"), 0);
  EXPECT_EQ(append(sut, disk, "third\n"), 0);
  EXPECT_EQ(disk.content(kFile), "first\nsec\nsecond\nthird\n");
}

TEST(AppendFile, MakesARemovedFileAgainAsAWholeOne) {
  FakeDisk disk;
  AppendFile sut(a_format());
  EXPECT_EQ(append(sut, disk, "a"), 0);
  EXPECT_EQ(sut.times_removed(), 0U);
  disk.unlink(kFile);
  EXPECT_EQ(append(sut, disk, "b"), 0);
  EXPECT_EQ(append(sut, disk, "c"), 0);
  EXPECT_EQ(sut.times_removed(), 1U);
  EXPECT_EQ(disk.content(kFile), "<(bc");
}

TEST(AppendFile, OpensAFileAnewAfterAnErrorOfTheDisk) {
  for (const int error : {EIO, EROFS}) {
    FakeDisk disk;
    AppendFile sut(a_format());
    EXPECT_EQ(append(sut, disk, "a"), 0);
    disk.write_error = error;
    EXPECT_EQ(append(sut, disk, "b"), error);
    EXPECT_EQ(disk.closed, 1);
    disk.open_error = error;
    EXPECT_EQ(append(sut, disk, "b"), error);
    disk.write_error = disk.open_error = 0;
    EXPECT_EQ(append(sut, disk, "b"), 0);
    EXPECT_EQ(disk.content(kFile), "<(ab");
  }
}

TEST(AppendFile, OnTheRealDiskMakesItsFolderAndComesBackAfterRemoval) {
  const ScratchFolder folder;
  RealDisk disk;
  AppendFile sut({.file = folder.path() / "a" / "b" / "file", .preamble = to_bytes("<")});
  EXPECT_EQ(append(sut, disk, "1"), 0);
  std::filesystem::remove_all(folder.path() / "a");
  EXPECT_EQ(append(sut, disk, "2"), 0);
  EXPECT_EQ(sut.finish(disk), 0);
  EXPECT_EQ(folder.read("a/b/file"), "<2");
}

TEST(AppendFile, ReportsWhatTheRealDiskRefuses) {
  RealDisk disk;
  AppendFile full({.file = "/dev/full"});
  EXPECT_EQ(append(full, disk, "1"), ENOSPC);
  AppendFile nowhere({.file = "/dev/null/file"});
  EXPECT_EQ(append(nowhere, disk, "1"), ENOTDIR);
}

TEST(RealDisk, ReplacesAWholeFileOrLeavesItAsItWas) {
  const ScratchFolder folder;
  RealDisk disk;
  EXPECT_EQ(disk.replace(folder.path() / "new" / "file", "one"), 0);
  EXPECT_EQ(disk.replace(folder.path() / "new" / "file", "two"), 0);
  EXPECT_EQ(folder.read("new/file"), "two");
  std::filesystem::create_directory(folder / "folder");
  EXPECT_EQ(disk.replace(folder / "folder", "text"), EISDIR);
  EXPECT_EQ(folder.entries(), 2) << "no temporary file stays";
  EXPECT_EQ(disk.remove(folder.path() / "new" / "file"), 0);
  EXPECT_EQ(disk.remove(folder.path() / "new" / "file"), 0);
  EXPECT_FALSE(disk.exists(folder.path() / "new" / "file"));
}

}  // namespace
}  // namespace swarm::files
