// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/robot_log/robot_log_file.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "swarm_core/files/append_file.hpp"
#include "swarm_core/files/disk.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::robot_log {
namespace {

UtcTime at_ms(std::int64_t ms) { return UtcTime(std::chrono::milliseconds(ms)); }

Header a_header() {
  return {.robot = RobotId(42),
          .robots = 500,
          .process_id = 1234,
          .radius_m = 0.2,
          .stamp = at_ms(1'700'000'000'000)};
}

Step step_number(int i) {
  return {.stamp = at_ms(1'700'000'000'000 + 100 * i),
          .position_m = {0.1 * i, -2.5},
          .velocity_mps = {1.0, 1e-3 * i},
          .lateness_us = i % 2 == 0 ? -i : i,
          .mode = static_cast<std::uint8_t>(i % 5),
          .goal = static_cast<std::uint8_t>(i % 3 == 0 ? Step::kNoGoal : 2),
          .neighbours = static_cast<std::uint16_t>(i)};
}

LinkStats some_stats() {
  LinkStats stats{.stamp = at_ms(5), .states_sent = 7, .states_received = 4'000'000'000U};
  stats.refused = {0, 3, 0, 9};
  for (int i = 0; i < 300; ++i) stats.state_age.add(37 * i * i);
  return stats;
}

Note a_note(std::string code, std::string text = "why") {
  return {.stamp = at_ms(9), .caused = at_ms(8), .code = std::move(code), .text = std::move(text)};
}

void expect_step(const Record& record, const Step& expected) {
  const Step* step = std::get_if<Step>(&record);
  ASSERT_NE(step, nullptr);
  EXPECT_EQ(step->stamp, expected.stamp);
  EXPECT_EQ(step->position_m, expected.position_m);
  EXPECT_EQ(step->velocity_mps, expected.velocity_mps);
  EXPECT_EQ(step->lateness_us, expected.lateness_us);
  EXPECT_EQ(step->mode, expected.mode);
  EXPECT_EQ(step->goal, expected.goal);
  EXPECT_EQ(step->neighbours, expected.neighbours);
}

/// A file name of this test's own that is removed afterwards.
class RobotLogFile : public testing::Test {
 protected:
  RobotLogFile() {
    folder_ = std::filesystem::temp_directory_path() /
              ("robot_log_test_" + std::to_string(::getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    file_ = file_of(folder_, RobotId(42));
  }
  ~RobotLogFile() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  void write(const std::vector<Record>& records) const {
    auto writer = Writer::open(file_);
    ASSERT_TRUE(writer.has_value()) << writer.error().message;
    for (const Record& record : records) writer->append(record);
    EXPECT_EQ(writer->dropped(), 0U);
  }
  std::vector<Record> steps(int n) const {
    std::vector<Record> records{a_header()};
    for (int i = 0; i < n; ++i) records.emplace_back(step_number(i));
    return records;
  }
  /// Of a file with one more record of that kind.
  std::size_t header_bytes() const {
    return size_of({a_header(), a_header()}) - size_of({a_header()});
  }
  std::size_t step_bytes() const { return size_of(steps(1)) - size_of(steps(0)); }
  std::size_t size_of(const std::vector<Record>& records) const {
    const auto file = folder_ / "another";
    std::filesystem::remove(file);
    auto writer = Writer::open(file);
    for (const Record& record : records) writer->append(record);
    writer = Writer::open("/dev/null");
    return std::filesystem::file_size(file);
  }
  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void set_bytes(const std::string& bytes) const {
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes;
  }

  std::filesystem::path folder_;
  std::filesystem::path file_;
};

TEST_F(RobotLogFile, IsNamedByItsRobot) {
  EXPECT_EQ(file_of("run", RobotId(42)), std::filesystem::path("run/blackbox/robot-00042.mcap"));
}

TEST_F(RobotLogFile, ReadsBackEveryKindOfRecord) {
  write({a_header(), step_number(1), some_stats(), a_note("exit"), step_number(4),
         Estimate{.stamp = at_ms(3), .neighbour = RobotId(7), .position_m = {1.5, -2.5}}});

  const auto file = read_file(file_);

  ASSERT_TRUE(file.has_value()) << file.error().message;
  EXPECT_EQ(file->damaged, 0U);
  EXPECT_FALSE(file->truncated);
  ASSERT_EQ(file->records.size(), 6U);
  const Header& header = std::get<Header>(file->records[0]);
  EXPECT_EQ(header.robot, RobotId(42));
  EXPECT_EQ(header.robots, 500U);
  EXPECT_EQ(header.process_id, 1234U);
  EXPECT_EQ(header.radius_m, 0.2);
  EXPECT_EQ(header.stamp, a_header().stamp);
  expect_step(file->records[1], step_number(1));
  const LinkStats& stats = std::get<LinkStats>(file->records[2]);
  EXPECT_EQ(stats.states_received, 4'000'000'000U);
  EXPECT_EQ(stats.refused, some_stats().refused);
  for (std::size_t i = 0; i < Histogram::kBins; ++i) {
    EXPECT_EQ(stats.state_age.bin(i), some_stats().state_age.bin(i));
  }
  const Note& note = std::get<Note>(file->records[3]);
  EXPECT_EQ(note.code, "exit");
  EXPECT_EQ(note.text, "why");
  EXPECT_EQ(note.caused, at_ms(8));
  const Estimate& estimate = std::get<Estimate>(file->records[5]);
  EXPECT_EQ(estimate.stamp, at_ms(3));
  EXPECT_EQ(estimate.neighbour, RobotId(7));
  EXPECT_EQ(estimate.position_m, Vec2(1.5, -2.5));
  expect_step(file->records[4], step_number(4));
}

TEST_F(RobotLogFile, IsContinuedByTheNextIncarnation) {
  write(steps(3));
  write(steps(2));

  const auto file = read_file(file_);

  ASSERT_TRUE(file.has_value());
  EXPECT_EQ(file->records.size(), 7U);
  EXPECT_EQ(file->damaged, 0U);
}

TEST_F(RobotLogFile, CutsTextsThatAreTooLong) {
  write({a_note("code", std::string(100'000, 'x')), step_number(1)});

  const auto file = read_file(file_);

  ASSERT_TRUE(file.has_value());
  ASSERT_EQ(file->records.size(), 2U);
  EXPECT_EQ(std::get<Note>(file->records[0]).text, std::string(4096, 'x'));
}

TEST_F(RobotLogFile, StaysReadableWhenItsWriterIsKilled) {
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto writer = Writer::open(file_);
    if (!writer) ::_exit(1);
    writer->append(a_header());
    for (int i = 0;; ++i) {
      writer->append(step_number(i));
      if (i == 1000 && ::write(pipe_ends[1], "x", 1) != 1) ::_exit(1);
    }
  }
  char ready = 0;
  ASSERT_EQ(::read(pipe_ends[0], &ready, 1), 1);
  ::kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ::close(pipe_ends[0]);
  ::close(pipe_ends[1]);
  ASSERT_TRUE(WIFSIGNALED(status));

  const auto file = read_file(file_);

  ASSERT_TRUE(file.has_value()) << file.error().message;
  EXPECT_EQ(file->damaged, 0U);
  ASSERT_GE(file->records.size(), 1002U);
  for (int i = 0; i + 1 < static_cast<int>(file->records.size()); ++i) {
    expect_step(file->records[static_cast<std::size_t>(i) + 1], step_number(i));
  }
}

TEST_F(RobotLogFile, CutAnywhereLosesOnlyTheLastRecord) {
  write(steps(3));
  const std::string whole = bytes();
  const std::size_t end = whole.size() - mcap::plain_end().size();
  write(steps(4));
  const std::size_t record = (bytes().size() - whole.size() - header_bytes()) / 4;
  const std::size_t first_step = end - 3 * record;
  for (std::size_t size = first_step; size <= end; ++size) {
    set_bytes(whole.substr(0, size));

    const auto file = read_file(file_);

    ASSERT_TRUE(file.has_value());
    EXPECT_EQ(file->records.size(), 1 + (size - first_step) / record);
    EXPECT_EQ(file->truncated, (size - first_step) % record != 0) << size;
    EXPECT_EQ(file->damaged, 0U);
  }
}

TEST_F(RobotLogFile, DetectsEveryFlippedBitAndReadsOn) {
  write(steps(6));
  const std::string whole = bytes();
  const std::size_t records = whole.size() - mcap::plain_end().size() - 6 * step_bytes();
  for (std::size_t byte = records; byte + mcap::plain_end().size() < whole.size(); ++byte) {
    std::string broken = whole;
    broken[byte] = static_cast<char>(broken[byte] ^ (1 << (byte % 8)));
    set_bytes(broken);

    const auto file = read_file(file_);

    ASSERT_TRUE(file.has_value());
    // Exactly the record that contains the bit is lost, and the reader reports the damage.
    EXPECT_EQ(file->records.size(), 6U) << "byte " << byte;
    EXPECT_EQ(file->damaged + (file->truncated ? 1U : 0U), 1U) << "byte " << byte;
  }
}

TEST_F(RobotLogFile, SurvivesGarbage) {
  write(steps(20));
  const std::string whole = bytes();
  Rng rng(11);
  for (int round = 0; round < 300; ++round) {
    std::string broken = whole;
    const std::size_t head = broken.size() - 20 * step_bytes();
    for (int i = 0; i < 1 + round % 20; ++i) {
      broken[head + rng() % (broken.size() - head)] = static_cast<char>(rng());
    }
    broken.insert(head + rng() % (broken.size() - head), std::string(1 + rng() % 90, '\x02'));
    set_bytes(broken);

    const auto file = read_file(file_);

    ASSERT_TRUE(file.has_value());
    EXPECT_LE(file->records.size(), 21U);
    EXPECT_GT(file->damaged + (file->truncated ? 1U : 0U), 0U);
  }
}

TEST_F(RobotLogFile, RefusesNumbersThatAreNotFinite) {
  Step bad = step_number(1);
  bad.position_m.x() = std::numeric_limits<double>::quiet_NaN();
  write({step_number(0), bad, step_number(2)});

  const auto file = read_file(file_);

  ASSERT_TRUE(file.has_value());
  EXPECT_EQ(file->records.size(), 2U);
  EXPECT_EQ(file->damaged, 1U);
}

TEST_F(RobotLogFile, RefusesOtherFiles) {
  std::filesystem::create_directories(file_.parent_path());
  set_bytes("#!/bin/sh\necho hello\n");
  EXPECT_FALSE(read_file(file_).has_value());
  EXPECT_FALSE(read_file(folder_ / "missing").has_value());
  EXPECT_FALSE(read_file(folder_).has_value());
}

TEST_F(RobotLogFile, OfAProcessKilledBeforeItsFirstRecordIsEmpty) {
  std::filesystem::create_directories(file_.parent_path());
  set_bytes("");

  const auto file = read_file(file_);

  ASSERT_TRUE(file.has_value());
  EXPECT_TRUE(file->records.empty());
  EXPECT_TRUE(file->truncated);
}

TEST_F(RobotLogFile, DropsAndCountsWhatAFullDiskRefuses) {
  auto writer = Writer::open("/dev/full");
  ASSERT_TRUE(writer.has_value()) << writer.error().message;

  for (int i = 0; i < 10; ++i) writer->append(step_number(i));

  EXPECT_EQ(writer->dropped(), 10U);
}

TEST_F(RobotLogFile, ReportsWhyItCannotBeOpened) {
  const auto writer = Writer::open("/dev/null/robot.mcap");

  ASSERT_FALSE(writer.has_value());
  EXPECT_EQ(writer.error().code, ErrorCode::kEnvironment);
  EXPECT_NE(writer.error().message.find("/dev/null/robot.mcap"), std::string::npos);
}

/// Keeps the chunks that a test wants, and drops the others.
class PickySink final : public ChunkSink {
 public:
  PickySink(std::vector<mcap::Bytes>& kept, std::vector<int> drops)
      : kept_(kept), drops_(std::move(drops)) {}
  void append(std::span<const unsigned char> chunk, std::uint32_t records) override {
    if (std::find(drops_.begin(), drops_.end(), number_++) != drops_.end()) {
      dropped_ += records;
    } else {
      kept_.emplace_back(chunk.begin(), chunk.end());
    }
  }
  std::uint64_t dropped() const override { return dropped_; }

 private:
  std::vector<mcap::Bytes>& kept_;
  std::vector<int> drops_;
  int number_ = 0;
  std::uint64_t dropped_ = 0;
};

TEST_F(RobotLogFile, NumbersRecordsSoThatReadersCountTheMissingOnes) {
  std::vector<mcap::Bytes> chunks;
  std::uint64_t dropped = 0;
  {
    Writer writer =
        Writer::to(std::make_unique<PickySink>(chunks, std::vector<int>{0, 3, 4}), a_header());
    for (int i = 0; i < 8; ++i) writer.append(step_number(i));
    dropped = writer.dropped();
  }
  files::RealDisk disk;
  for (int incarnation = 0; incarnation < 2; ++incarnation) {
    files::AppendFile file(format_of(file_, a_header()));
    for (const mcap::Bytes& chunk : chunks) EXPECT_EQ(file.append(disk, chunk), 0);
    EXPECT_EQ(file.finish(disk), 0);
  }

  const auto read = read_file(file_);

  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(dropped, 3U);
  EXPECT_EQ(read->lost, 2U * 3U);
  EXPECT_EQ(read->damaged, 0U);
  EXPECT_TRUE(read->ended);
  EXPECT_EQ(read->records.size(), 2U * (1U + 5U));
}

TEST_F(RobotLogFile, LacksNothingOfAWholeLog) {
  write(steps(20));
  write(steps(3));
  const auto read = read_file(file_);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->lost, 0U);
}

TEST_F(RobotLogFile, CanBeWrittenManyRecordsAtATime) {
  auto writer = Writer::open(file_, 10, 4);
  ASSERT_TRUE(writer.has_value());
  const auto records_in_file = [&] {
    const auto file = read_file(file_);
    return file ? file->records.size() : 0;
  };
  for (int i = 0; i < 5; ++i) writer->append(step_number(i));
  EXPECT_EQ(records_in_file(), 0U);
  writer->append(step_number(5));
  EXPECT_EQ(records_in_file(), 6U);
  for (int i = 6; i < 18; ++i) writer->append(step_number(i));
  EXPECT_EQ(records_in_file(), 16U);
  *writer = *Writer::open("/dev/full");  // the old one ends
  EXPECT_EQ(records_in_file(), 18U);
}

}  // namespace
}  // namespace swarm::robot_log
