// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/file_watch.hpp"

#include <cerrno>

#include <gtest/gtest.h>

namespace swarm::shell {
namespace {

TEST(FileWatch, IsQuietAsLongAsAllIsWritten) {
  FileWatch sut;
  EXPECT_FALSE(sut.step({}));
  EXPECT_FALSE(sut.step({}));
}

TEST(FileWatch, ReportsTheBeginAndTheEndOfAFault) {
  FileWatch sut;
  const auto begin = sut.step({.failing = 3, .first = "/run/events.jsonl", .error = ENOSPC});
  ASSERT_TRUE(begin);
  EXPECT_TRUE(begin->is_warning);
  EXPECT_EQ(begin->code, kDiskFails);
  EXPECT_EQ(begin->text,
            "events.jsonl cannot be written: No space left on device; 3 files in all; records wait "
            "in memory");
  EXPECT_FALSE(sut.step({.failing = 1, .first = "/run/plan.json", .error = EIO}));
  const auto end = sut.step({});
  ASSERT_TRUE(end);
  EXPECT_FALSE(end->is_warning);
  EXPECT_EQ(end->code, kDiskWorks);
  EXPECT_FALSE(sut.step({}));
}

TEST(FileWatch, NamesADiskThatDoesNotAnswer) {
  FileWatch sut;
  const auto begin = sut.step({.failing = 1, .first = "/run/events.jsonl"});
  ASSERT_TRUE(begin);
  EXPECT_NE(begin->text.find("events.jsonl cannot be written: the disk does not answer"),
            std::string::npos);
}

// One event a fault, not one a record.
TEST(FileWatch, ReportsALossOnceWhenItsExtentIsKnown) {
  FileWatch sut;
  EXPECT_TRUE(sut.step({.failing = 1, .error = EIO}));
  EXPECT_FALSE(sut.step({.failing = 1, .error = EIO, .lost = 5}));
  EXPECT_FALSE(sut.step({.failing = 1, .error = EIO, .lost = 7}));
  EXPECT_TRUE(sut.step({.lost = 7}));  // works
  const auto lost = sut.step({.lost = 7});
  ASSERT_TRUE(lost);
  EXPECT_TRUE(lost->is_warning);
  EXPECT_EQ(lost->code, kRecordsLost);
  EXPECT_EQ(lost->text, "7 records found no room");
  EXPECT_FALSE(sut.step({.lost = 7}));
  EXPECT_EQ(sut.step({.lost = 8})->text, "1 record found no room");
}

TEST(FileWatch, ReportsFilesThatOthersRemoved) {
  FileWatch sut;
  const auto removed = sut.step({.removed = 2});
  ASSERT_TRUE(removed);
  EXPECT_EQ(removed->code, kRecordsLost);
  EXPECT_EQ(removed->text, "2 files were removed while in use and made again");
  EXPECT_FALSE(sut.step({.removed = 2}));
}

}  // namespace
}  // namespace swarm::shell
