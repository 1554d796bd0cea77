// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/event_log.hpp"

#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::launcher {
namespace {

using nlohmann::json;

class EventLogFile : public testing::Test {
 protected:
  std::vector<json> events() const {
    std::vector<json> all;
    std::istringstream lines(folder_.read("events.jsonl"));
    for (std::string line; std::getline(lines, line);) all.push_back(json::parse(line));
    return all;
  }
  ScratchFolder folder_;
};

// Read while the log is still open: a crash must lose none.
TEST_F(EventLogFile, HoldsEachEventAsSoonAsItIsWritten) {
  EventLog sut(append_to_file(folder_ / "events.jsonl"));
  for (int i = 1; i <= 3; ++i) {
    sut.write(UtcTime(Duration(1'700'000'000'000'000'000 + i)), "launcher",
              link::Severity::kWarning, "agent-exit", "agent process " + std::to_string(i));
    ASSERT_EQ(events().size(), static_cast<std::size_t>(i));
    EXPECT_EQ(events().back(), (json{{"utc_ns", 1'700'000'000'000'000'000 + i},
                                     {"source", "launcher"},
                                     {"severity", "warning"},
                                     {"code", "agent-exit"},
                                     {"text", "agent process " + std::to_string(i)}}));
  }
}

TEST_F(EventLogFile, TakesAnEventFromTheBusWithItsStampAndSource) {
  EventLog sut(append_to_file(folder_ / "events.jsonl"));
  const struct {
    std::uint32_t source;
    const char* name;
  } sources[] = {
      {7, "robot-7"}, {link::kPlannerSource, "planner"}, {link::kLauncherSource, "launcher"}};
  for (const auto& source : sources) {
    sut.write(link::EventMessage{.severity = link::Severity::kError,
                                 .source = source.source,
                                 .stamp_utc_ns = -5,
                                 .code = "robot-fault",
                                 .text = "no velocity"});
    EXPECT_EQ(events().back(), (json{{"utc_ns", -5},
                                     {"source", source.name},
                                     {"severity", "error"},
                                     {"code", "robot-fault"},
                                     {"text", "no velocity"}}));
  }
}

// One object a line for any text, since texts come from the bus.
TEST_F(EventLogFile, KeepsOneLinePerEventWhateverItsText) {
  EventLog sut(append_to_file(folder_ / "events.jsonl"));
  const std::vector<std::string> texts = {"", "two\nlines\r\n", "\"quoted\" \\ {}", "Ω \u2028",
                                          std::string("a\0b", 3)};
  for (const std::string& text : texts) sut.write({}, "s", link::Severity::kInfo, "c", text);
  sut.write({}, "s", link::Severity::kInfo, "c", "cut \xce");
  sut.write({}, "s", link::Severity::kInfo, "c", "\xff\xfe");

  const std::vector<json> all = events();
  ASSERT_EQ(all.size(), texts.size() + 2);
  for (std::size_t i = 0; i < texts.size(); ++i) EXPECT_EQ(all[i]["text"], texts[i]);
  EXPECT_EQ(all[texts.size()]["text"], "cut \uFFFD");
  EXPECT_EQ(all.back()["text"], "\uFFFD\uFFFD");
}

TEST_F(EventLogFile, GoesOnWhereAnEarlierOneEnded) {
  for (const char* code : {"one", "two"}) {
    EventLog sut(append_to_file(folder_ / "events.jsonl"));
    sut.write({}, "launcher", link::Severity::kInfo, code, "");
  }
  ASSERT_EQ(events().size(), 2U);
  EXPECT_EQ(events()[0]["code"], "one");
  EXPECT_EQ(events()[1]["code"], "two");
}

}  // namespace
}  // namespace swarm::launcher
