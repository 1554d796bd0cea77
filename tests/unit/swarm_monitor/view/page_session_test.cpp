// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/page_session.hpp"

#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/swarm_monitor/fake_view_source.hpp"
#include "tests/unit/swarm_monitor/frame_mutator.hpp"

namespace swarm::monitor {
namespace {

Result<std::string> no_control(const ControlRequest&) {
  return fail(ErrorCode::kBadInput, "no control");
}

std::string text_of(const Outgoing& out) {
  return {reinterpret_cast<const char*>(out.bytes.data()), out.bytes.size()};
}

TEST(PageRequest, IsReadAsWritten) {
  const auto frame = parse_page_request(R"({"op":"frame","t":12.5})");
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(std::get<FrameRequest>(*frame).time_s, 12.5);
  EXPECT_FALSE(std::get<FrameRequest>(*parse_page_request(R"({"op":"frame"})")).time_s);

  const auto focus = parse_page_request(R"({"op":"focus","robot":17})");
  EXPECT_EQ(std::get<FocusRequest>(*focus).robot, RobotId(17));
  EXPECT_FALSE(std::get<FocusRequest>(*parse_page_request(R"({"op":"focus","robot":null})")).robot);

  const auto obstacle = parse_page_request(
      R"({"op":"control","token":"t","action":"add_obstacle","x":1,"y":-2.5,"radius":3})");
  const auto& control = std::get<ControlRequest>(*obstacle);
  EXPECT_EQ(control.action, ControlAction::kAddObstacle);
  EXPECT_EQ(control.token, "t");
  EXPECT_EQ(control.y_m, -2.5);
  EXPECT_EQ(control.radius_m, 3.0);
}

TEST(PageRequest, OfAnyOtherKindIsRefused) {
  for (const char* text :
       {"",
        "{",
        "null",
        "[]",
        "7",
        R"({"op":7})",
        R"({"op":"fly"})",
        R"({"op":"frame","t":"1"})",
        R"({"op":"frame","t":1e999})",
        R"({"op":"frame","t":NaN})",
        R"({"op":"frame","t":null})",
        R"({"op":"focus"})",
        R"({"op":"focus","robot":-1})",
        R"({"op":"focus","robot":1.5})",
        R"({"op":"focus","robot":4294967295})",
        R"({"op":"control","token":"t"})",
        R"({"op":"control","action":"pause"})",
        R"({"op":"control","token":1,"action":"pause"})",
        R"({"op":"control","token":"t","action":"land"})",
        R"({"op":"control","token":"t","action":"goal","x":1})",
        R"({"op":"control","token":"t","action":"add_obstacle","x":1,"y":1,"radius":0})",
        "{\"op\":\"frame\xFF\"}"}) {
    EXPECT_FALSE(parse_page_request(text).has_value()) << text;
  }
}

TEST(PageSession, SendsAllThenWhatIsNew) {
  FakeViewSource source;
  ViewCounters counters;
  PageSession session(source, no_control, counters);
  Outgoing out;

  ASSERT_TRUE(session.next(out));
  EXPECT_EQ(text_of(out), source.scene_texts[0]);
  ASSERT_TRUE(session.next(out));
  EXPECT_EQ(text_of(out), R"({"op":"events","events":[{"t":0.5,"text":"one"}]})");
  ASSERT_TRUE(session.next(out));
  const auto series = nlohmann::json::parse(text_of(out));
  EXPECT_EQ(series["from"], 0);
  EXPECT_EQ(series["rows"].size(), 1U);
  EXPECT_FALSE(session.has_something());
  EXPECT_FALSE(session.next(out));

  source.rows.push_back("[1,1.2,0,3,null,24.1]");
  ASSERT_TRUE(session.has_something());
  ASSERT_TRUE(session.next(out));
  EXPECT_EQ(nlohmann::json::parse(text_of(out))["from"], 1);
}

TEST(PageSession, SendsTheNewestSceneLiveAndAllOfARecording) {
  FakeViewSource source;
  source.scene_texts = {"{\"n\":1}", "{\"n\":2}", "{\"n\":3}"};
  ViewCounters counters;
  Outgoing out;
  PageSession live(source, no_control, counters);
  ASSERT_TRUE(live.next(out));
  EXPECT_EQ(text_of(out), "{\"n\":3}");
  source.is_live = false;
  PageSession recording(source, no_control, counters);
  for (const char* scene : {"{\"n\":1}", "{\"n\":2}", "{\"n\":3}"}) {
    ASSERT_TRUE(recording.next(out));
    EXPECT_EQ(text_of(out), scene);
  }
}

TEST(PageSession, SendsALongRecordingInParts) {
  FakeViewSource source;
  source.event_texts.assign(10'000, fmt::format(R"({{"text":"{:x>100}"}})", ""));
  ViewCounters counters;
  PageSession session(source, no_control, counters);
  Outgoing out;
  std::size_t events = 0;
  while (session.next(out)) {
    EXPECT_LT(out.bytes.size(), 300'000U);
    const auto message = nlohmann::json::parse(text_of(out));
    if (message["op"] == "events") events += message["events"].size();
  }
  EXPECT_EQ(events, 10'000U);
}

TEST(PageSession, SendsOneFrameForAnyNumberOfRequests) {
  FakeViewSource source;
  ViewCounters counters;
  PageSession session(source, no_control, counters);
  Outgoing out;
  while (session.next(out)) {
  }
  session.take(R"({"op":"focus","robot":2})", false);
  for (int i = 0; i < 100; ++i) session.take(R"({"op":"frame","t":1.5})", false);
  ASSERT_TRUE(session.next(out));
  EXPECT_TRUE(out.binary);
  EXPECT_FALSE(session.next(out));
  ASSERT_EQ(source.asked.size(), 1U);
  EXPECT_EQ(source.asked[0].first, 1.5);
  EXPECT_EQ(source.asked[0].second, RobotId(2));
  EXPECT_EQ(counters.view_frames_sent, 1U);
}

TEST(PageSession, AnswersControl) {
  FakeViewSource source;
  ViewCounters counters;
  bool well = true;
  PageSession session(
      source,
      [&](const ControlRequest&) -> Result<std::string> {
        if (!well) return fail(ErrorCode::kBadInput, "no \xFF");
        return "paused";
      },
      counters);
  Outgoing out;
  session.take(R"({"op":"control","token":"t","action":"pause"})", false);
  ASSERT_TRUE(session.next(out));
  EXPECT_EQ(text_of(out), R"({"action":"pause","op":"done","text":"paused"})");
  well = false;
  session.take(R"({"op":"control","token":"t","action":"stop"})", false);
  ASSERT_TRUE(session.next(out));
  EXPECT_EQ(nlohmann::json::parse(text_of(out))["op"], "refused");
  EXPECT_EQ(session.refused(), 1U);
}

TEST(PageSession, GivesUpOnNonsense) {
  FakeViewSource source;
  ViewCounters counters;
  PageSession session(source, no_control, counters);
  for (int i = 0; i < 19; ++i) session.take("nonsense", i % 2 == 0);
  EXPECT_FALSE(session.hopeless());
  session.take("nonsense", false);
  EXPECT_TRUE(session.hopeless());
  EXPECT_EQ(counters.frames_refused, 20U);
}

TEST(PageSession, TakesAnyBytes) {
  FakeViewSource source;
  ViewCounters counters;
  FrameMutator mutator(7, {R"({"op":"frame","t":12.5})", R"({"op":"focus","robot":17})",
                           R"({"op":"control","token":"t","action":"goal","x":1,"y":2})"});
  PageSession session(source, no_control, counters);
  Outgoing out;
  for (int i = 0; i < 20'000; ++i) {
    session.take(mutator.next(), mutator.chance(0.05));
    if (mutator.chance(0.5)) session.next(out);
  }
  EXPECT_GT(counters.frames_refused, 1'000U);
  EXPECT_LT(counters.frames_refused, 20'000U);
}

}  // namespace
}  // namespace swarm::monitor
