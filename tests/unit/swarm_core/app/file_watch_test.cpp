// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/file_watch.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdint>

#include <gtest/gtest.h>

namespace swarm::shell {
namespace {

FileHealth health(std::size_t failing, int error, std::uint64_t lost = 0, std::uint32_t removed = 0,
                  const char* first = "") {
  FileHealth all;
  all.failing = failing;
  all.first = first;
  all.error = error;
  all.lost = lost;
  all.removed = removed;
  return all;
}

TEST(FileWatch, IsQuietAsLongAsAllIsWritten) {
  FileWatch sut;
  EXPECT_FALSE(sut.step({}));
  EXPECT_FALSE(sut.step({}));
}

TEST(FileWatch, ReportsTheBeginAndTheEndOfAFault) {
  FileWatch sut;
  const auto begin = sut.step(health(3, ENOSPC, 0, 0, "/run/events.jsonl"));
  ASSERT_TRUE(begin);
  EXPECT_TRUE(begin->is_warning);
  EXPECT_EQ(begin->code, kDiskFails);
  EXPECT_EQ(begin->text,
            "events.jsonl cannot be written: No space left on device; 3 files in all; records wait "
            "in memory");
  EXPECT_FALSE(sut.step(health(1, EIO, 0, 0, "/run/plan.json")));
  const auto end = sut.step({});
  ASSERT_TRUE(end);
  EXPECT_FALSE(end->is_warning);
  EXPECT_EQ(end->code, kDiskWorks);
  EXPECT_FALSE(sut.step({}));
}

TEST(FileWatch, NamesADiskThatDoesNotAnswer) {
  FileWatch sut;
  const auto begin = sut.step(health(1, 0, 0, 0, "/run/events.jsonl"));
  ASSERT_TRUE(begin);
  EXPECT_NE(begin->text.find("events.jsonl cannot be written: the disk does not answer"),
            std::string::npos);
}

// One event a fault, not one a record.
TEST(FileWatch, ReportsALossOnceWhenItsExtentIsKnown) {
  FileWatch sut;
  EXPECT_TRUE(sut.step(health(1, EIO)));
  EXPECT_FALSE(sut.step(health(1, EIO, 5)));
  EXPECT_FALSE(sut.step(health(1, EIO, 7)));
  EXPECT_TRUE(sut.step(health(0, 0, 7)));  // works
  const auto lost = sut.step(health(0, 0, 7));
  ASSERT_TRUE(lost);
  EXPECT_TRUE(lost->is_warning);
  EXPECT_EQ(lost->code, kRecordsLost);
  EXPECT_EQ(lost->text, "7 records found no room");
  EXPECT_FALSE(sut.step(health(0, 0, 7)));
  EXPECT_EQ(sut.step(health(0, 0, 8))->text, "1 record found no room");
}

TEST(FileWatch, ReportsFilesThatOthersRemoved) {
  FileWatch sut;
  const auto removed = sut.step(health(0, 0, 0, 2));
  ASSERT_TRUE(removed);
  EXPECT_EQ(removed->code, kRecordsLost);
  EXPECT_EQ(removed->text, "2 files were removed while in use and made again");
  EXPECT_FALSE(sut.step(health(0, 0, 0, 2)));
}

}  // namespace
}  // namespace swarm::shell
