// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/program/process_events.hpp"

#include <cerrno>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/robot_agent/program/process_bench.hpp"

namespace swarm::agent {
namespace {

class ProcessEventsTest : public ProcessBench {
 protected:
  ProcessEventsTest() : ProcessBench(3) {}

  /// The events of the next tick, as "code: text".
  std::vector<std::string> tick(Duration later = milliseconds(100)) {
    receive(later);
    events_.on_tick(steady(), utc(), sut_, ages_);
    std::vector<std::string> texts;
    for (const link::EventMessage& event : writer_.take()) {
      EXPECT_EQ(event.source, 0U);
      EXPECT_EQ(event.stamp_utc_ns, utc_ns());
      texts.push_back(event.code + ": " + event.text);
      severity_ = event.severity;
    }
    return texts;
  }
  /// The records of a kind in a robot's log.
  template <class Kind>
  std::vector<Kind> logged(std::uint32_t robot) const {
    std::vector<Kind> records;
    const auto read =
        robot_log::read_records(log_of(RobotId(robot)), [&](const robot_log::Record& record) {
          if (const auto* one = std::get_if<Kind>(&record)) records.push_back(*one);
        });
    EXPECT_TRUE(read.has_value());
    return records;
  }

  using Texts = std::vector<std::string>;
  KeepingWriter<link::EventMessage> writer_;
  ProcessEvents events_{robots_, writer_};
  link::Severity severity_ = link::Severity::kInfo;
  Duration sut_events_at_{};
};

TEST_F(ProcessEventsTest, AnnounceEachLossAndReturnOfThePlannerOnce) {
  EXPECT_EQ(tick(), Texts{});
  send_heartbeat(1, 0.0);
  EXPECT_EQ(tick(), Texts{"planner-heard: receives the planner"});
  EXPECT_EQ(tick(seconds(2)), Texts{});
  EXPECT_EQ(tick(), Texts{"planner-silent: planner silent: holds with avoidance on"});
  EXPECT_EQ(severity_, link::Severity::kWarning);
  EXPECT_EQ(tick(seconds(9)), Texts{});
  send_heartbeat(1, 9.0);
  EXPECT_EQ(tick(), Texts{"planner-heard: receives the planner"});

  // The audit reads logs alone.
  ASSERT_EQ(logged<robot_log::Note>(0).size(), 3U);
  EXPECT_EQ(logged<robot_log::Note>(0)[1].code, "planner-silent");
  EXPECT_TRUE(logged<robot_log::Note>(1).empty());
}

TEST_F(ProcessEventsTest, AnnounceWhyRobotsStandAndWhenTheyMoveAgain) {
  const auto permit = [&](StandReason reason, Duration later = milliseconds(100)) {
    sut_events_at_ += later;
    events_.on_permit(steady() + sut_events_at_, utc(), reason);
    std::vector<std::string> codes;
    for (const link::EventMessage& event : writer_.take()) codes.push_back(event.code);
    return codes;
  };
  EXPECT_EQ(permit(StandReason::kCutOff), Texts{}) << "not started yet";
  EXPECT_EQ(permit(StandReason::kNone), Texts{});
  EXPECT_EQ(permit(StandReason::kCutOff), Texts{"cut-off"});
  EXPECT_EQ(permit(StandReason::kCutOff), Texts{});
  EXPECT_EQ(permit(StandReason::kNone), Texts{"moves-again"});
  EXPECT_EQ(permit(StandReason::kCellsMissing), Texts{"cells-missing"});
  EXPECT_EQ(permit(StandReason::kNone), Texts{"moves-again"});
  EXPECT_EQ(permit(StandReason::kIsObstacle), Texts{"is-obstacle"});
  EXPECT_EQ(permit(StandReason::kNone), Texts{"moves-again"});
  EXPECT_EQ(permit(StandReason::kWaking), Texts{"woke-late"});
  EXPECT_EQ(permit(StandReason::kNone), Texts{"moves-again"});
  EXPECT_EQ(permit(StandReason::kWaking), Texts{}) << "once in ten seconds";
  EXPECT_EQ(permit(StandReason::kNone), Texts{});
  EXPECT_EQ(permit(StandReason::kWaking, seconds(10)), Texts{"woke-late"});
}

TEST_F(ProcessEventsTest, AnnounceThatCellsAreMissingAlsoBeforeTheFirstMove) {
  events_.on_permit(steady(), utc(), StandReason::kCellsMissing);
  EXPECT_EQ(writer_.take().size(), 1U);
  events_.on_permit(steady(), utc(), StandReason::kFilesMissing);
  const auto events = writer_.take();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].code, "cells-missing");
  EXPECT_NE(events[0].text.find("ulimit -n"), std::string::npos);
}

TEST_F(ProcessEventsTest, AnnounceEachLossAndReturnOfTheLauncherOnce) {
  std::vector<std::string> codes;
  for (const bool is_lost : {false, true, true, false, false}) {
    events_.on_launcher(utc(), is_lost);
    for (const link::EventMessage& event : writer_.take()) codes.push_back(event.code);
  }
  EXPECT_EQ(codes, (Texts{"launcher-silent", "launcher-back"}));
}

TEST_F(ProcessEventsTest, AnnounceAFaultWhenItBeginsAndWhenItEnds) {
  driver(2).is_valid = false;
  step(2);
  EXPECT_EQ(tick(), Texts{"robot-fault: robot 2: the driver has no position; the robot holds"});
  EXPECT_EQ(severity_, link::Severity::kError);
  step(2);
  EXPECT_EQ(tick(), Texts{});
  driver(2).is_valid = true;
  step(2);
  EXPECT_EQ(tick(), Texts{"robot-fault: robot 2: works again"});
  EXPECT_EQ(severity_, link::Severity::kInfo);
  EXPECT_EQ(tick(), Texts{});
}

TEST_F(ProcessEventsTest, AnnounceRefusalsByReasonOnceASecond) {
  EXPECT_EQ(tick(), Texts{});
  send_state(8, utc_ns());
  send_state(9, utc_ns());
  send_state(3, utc_ns());     // under our own id
  EXPECT_EQ(tick(), Texts{});  // not before the second is over
  send_state(8, utc_ns());
  EXPECT_EQ(tick(seconds(1)),
            (Texts{"refused: 3 message(s): out-of-range", "refused: 1 message(s): forged"}));
  EXPECT_EQ(tick(seconds(1)), Texts{});
  send_state(8, utc_ns());
  EXPECT_EQ(tick(seconds(1)), Texts{"refused: 1 message(s): out-of-range"});
}

TEST_F(ProcessEventsTest, AnnounceADuplicateIdOnce) {
  EXPECT_EQ(tick(), Texts{});
  send_state(3, utc_ns(-milliseconds(50)));
  EXPECT_EQ(tick(), Texts{"duplicate-id: robot 3: a state arrived under its id that it did not "
                          "publish: another process uses the id, or forges states"});
  EXPECT_EQ(severity_, link::Severity::kError);
  send_state(3, utc_ns(-milliseconds(50)));
  EXPECT_EQ(tick(), Texts{});
}

TEST_F(ProcessEventsTest, AnnounceClocksThatDiffer) {
  tick();
  send_state(1, utc_ns(-seconds(3)));
  send_state(2, utc_ns(-seconds(3)));
  EXPECT_EQ(tick(seconds(1)), Texts{"clock-skew: 2 state(s) from a clock that differs from ours"});
  EXPECT_EQ(tick(seconds(1)), Texts{});
}

TEST_F(ProcessEventsTest, NameTheRobotsThatATickOverrunStopped) {
  events_.on_overrun(utc(), milliseconds(1260));

  ASSERT_EQ(writer_.written.size(), 1U);
  EXPECT_EQ(writer_.written[0].severity, link::Severity::kError);
  EXPECT_EQ(writer_.written[0].code, "tick-overrun");
  EXPECT_EQ(writer_.written[0].text,
            "robots 0 to 2: a tick took 1.3 s; their commands ran out, so their bodies stopped "
            "meanwhile");
}

TEST_F(ProcessEventsTest, AnnounceTheBeginAndTheEndOfADiskFault) {
  events_.on_files(utc(), {});
  shell::FileHealth full;
  full.failing = 1;
  full.error = ENOSPC;
  events_.on_files(utc(), full);
  events_.on_files(utc(), full);
  events_.on_files(utc(), {});

  ASSERT_EQ(writer_.written.size(), 2U);
  EXPECT_EQ(writer_.written[0].code, "disk-fails");
  EXPECT_EQ(writer_.written[0].severity, link::Severity::kWarning);
  EXPECT_EQ(writer_.written[1].code, "disk-works");
  EXPECT_EQ(writer_.written[1].severity, link::Severity::kInfo);
}

// The log takes nothing any more: on the bus alone.
TEST_F(ProcessEventsTest, SendWhatIsMissingAtTheEnd) {
  events_.on_losses(utc(), {});
  EXPECT_TRUE(writer_.written.empty());
  const std::vector<shell::FileLoss> losses = {
      {.file = "/run/robot-00000.mcap", .records = 7, .error = ENOSPC},
      {.file = "/run/robot-00001.mcap", .records = 8}};
  events_.on_losses(utc(), losses);

  ASSERT_EQ(writer_.written.size(), 1U);
  EXPECT_EQ(writer_.written[0].code, "records-lost");
  EXPECT_EQ(writer_.written[0].text,
            "robot-00000.mcap: 7 records (No space left on device); and 1 more");
  EXPECT_TRUE(logged<robot_log::Note>(0).empty());
}

// Each robot has its own counters once a second; those of the process are in the first log alone.
TEST_F(ProcessEventsTest, RecordTheCountersOfTheLink) {
  ages_.add(5);
  send_state(8, utc_ns());
  for (int k = 0; k < 25; ++k) tick();

  for (std::uint32_t robot = 0; robot < 3; ++robot) {
    const auto stats = logged<robot_log::LinkStats>(robot);
    ASSERT_EQ(stats.size(), 3U) << robot;  // at 0.1, 1.1 and 2.1 s
    EXPECT_EQ(stats[1].stamp - stats[0].stamp, seconds(1));
    EXPECT_EQ(stats[0].state_age.count(), robot == 0 ? 1U : 0U);
    EXPECT_EQ(stats[0].refused.empty(), robot != 0);
  }
}

}  // namespace
}  // namespace swarm::agent
