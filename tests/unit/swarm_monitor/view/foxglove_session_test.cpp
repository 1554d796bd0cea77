// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/foxglove_session.hpp"

#include <cstring>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "swarm_monitor/view/foxglove_feed.hpp"
#include "swarm_monitor/view/foxglove_messages.hpp"
#include "swarm_monitor/view/foxglove_schemas.hpp"
#include "tests/unit/swarm_monitor/fake_view_source.hpp"
#include "tests/unit/swarm_monitor/frame_mutator.hpp"

namespace swarm::monitor {
namespace {

/// Reads plain CDR back.
class CdrReader {
 public:
  explicit CdrReader(const std::vector<std::byte>& bytes) : bytes_(bytes) {
    EXPECT_EQ(std::memcmp(bytes.data(), "\0\1\0\0", 4), 0);
  }
  template <class T>
  T get() {
    while ((at_ - 4) % sizeof(T) != 0) ++at_;
    T value{};
    if (at_ + sizeof(T) > bytes_.size()) throw std::out_of_range("CDR");
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  std::string text() {
    std::string value(get<std::uint32_t>(), '\0');
    for (char& c : value) c = static_cast<char>(get<std::uint8_t>());
    EXPECT_EQ(value.back(), '\0');
    value.pop_back();
    return value;
  }
  std::vector<double> doubles(std::size_t count) {
    std::vector<double> values(count);
    for (double& value : values) value = get<double>();
    return values;
  }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  const std::vector<std::byte>& bytes_;
  std::size_t at_ = 4;
};

/// Up to the cylinders of the only entity.
void expect_entity(CdrReader& cdr, const std::string& id) {
  EXPECT_EQ(cdr.get<std::uint32_t>(), 0U) << "deletions";
  EXPECT_EQ(cdr.get<std::uint32_t>(), 1U) << "entities";
  EXPECT_EQ(cdr.get<std::uint32_t>(), 5U);
  EXPECT_EQ(cdr.get<std::uint32_t>(), 7U);
  EXPECT_EQ(cdr.text(), "map");
  EXPECT_EQ(cdr.text(), id);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(cdr.get<std::uint32_t>(), 0U) << "lifetime";
  EXPECT_EQ(cdr.get<std::uint8_t>(), 0U) << "frame_locked";
  for (int i = 0; i < 4; ++i) EXPECT_EQ(cdr.get<std::uint32_t>(), 0U) << "metadata to spheres";
}

const UtcTime kNow{Duration(5'000'000'007)};

ViewFrame view_frame_of(FakeViewSource& source) {
  std::vector<std::byte> bytes;
  source.view_frame(std::nullopt, std::nullopt, bytes);
  const auto view_frame = read_view_frame(bytes);
  EXPECT_TRUE(view_frame.has_value());
  return view_frame.value_or(ViewFrame{});
}

std::string text_of(const Outgoing& out) {
  return {reinterpret_cast<const char*>(out.bytes.data()), out.bytes.size()};
}

TEST(FoxgloveMessages, PosesAreOfReceivedRobots) {
  FakeViewSource source;
  const auto bytes = foxglove::poses_in_frame(kNow, view_frame_of(source));
  CdrReader cdr(bytes);
  EXPECT_EQ(cdr.get<std::uint32_t>(), 5U);
  EXPECT_EQ(cdr.get<std::uint32_t>(), 7U);
  EXPECT_EQ(cdr.text(), "map");
  ASSERT_EQ(cdr.get<std::uint32_t>(), 2U);
  for (const double x_m : {0.0, 2.0}) {
    const auto pose = cdr.doubles(7);
    EXPECT_EQ(pose[0], x_m);
    EXPECT_EQ(pose[1], 2.0);
    EXPECT_NEAR(2.0 * std::atan2(pose[5], pose[6]), 0.5, 1e-9);
  }
  EXPECT_TRUE(cdr.at_end());
}

TEST(FoxgloveMessages, TheMixtureIsOfEllipses) {
  FakeViewSource source;
  const auto bytes = foxglove::mixture_scene(kNow, view_frame_of(source));
  CdrReader cdr(bytes);
  expect_entity(cdr, "mixture");
  ASSERT_EQ(cdr.get<std::uint32_t>(), 1U) << "cylinders";
  const auto pose = cdr.doubles(7);
  EXPECT_EQ(pose[0], 10.0);
  EXPECT_EQ(pose[1], 20.0);
  const auto size = cdr.doubles(3);
  EXPECT_NEAR(size[0], 8.0, 1e-6) << "covariance (4, 1): four deviations of 2 m";
  EXPECT_NEAR(size[1], 4.0, 1e-6);
  cdr.doubles(6);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(cdr.get<std::uint32_t>(), 0U) << "lines to models";
  EXPECT_TRUE(cdr.at_end());
}

TEST(FoxgloveMessages, ObstaclesAreThoseOfTheScene) {
  const FakeViewSource source;
  const auto bytes = foxglove::obstacles_scene(kNow, source.scene_texts[0]);
  CdrReader cdr(bytes);
  expect_entity(cdr, "obstacles");
  ASSERT_EQ(cdr.get<std::uint32_t>(), 1U) << "cylinders";
  EXPECT_EQ(cdr.doubles(7)[1], 6.0);
  EXPECT_EQ(cdr.doubles(3)[0], 4.0);
  cdr.doubles(6);
  ASSERT_EQ(cdr.get<std::uint32_t>(), 1U) << "lines";
  EXPECT_EQ(cdr.get<std::uint32_t>(), 1U) << "LINE_LOOP";
  cdr.doubles(8);
  cdr.get<std::uint8_t>();
  ASSERT_EQ(cdr.get<std::uint32_t>(), 3U) << "points";
  EXPECT_EQ(cdr.doubles(9)[7], 2.0);
  cdr.doubles(4);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(cdr.get<std::uint32_t>(), 0U);
  EXPECT_TRUE(cdr.at_end());
}

TEST(FoxgloveMessages, AnySceneWillDo) {
  for (const char* scene :
       {"", "7", "{}", R"({"obstacles":3})", R"({"obstacles":[3,{"circle":[1]}]})",
        R"({"obstacles":[{"polygon":[3,["a","b"]]}]})"}) {
    EXPECT_FALSE(foxglove::obstacles_scene(kNow, scene).empty()) << scene;
  }
}

TEST(FoxgloveMessages, RefusesABrokenFrame) {
  FakeViewSource source;
  std::vector<std::byte> bytes;
  source.view_frame(std::nullopt, std::nullopt, bytes);
  for (std::size_t size = 0; size < 24 + 3 * 16 + 24; ++size) {
    EXPECT_FALSE(read_view_frame(std::span(bytes).first(size)).has_value()) << size;
  }
  std::memset(bytes.data() + 4, 0xFF, 4);
  EXPECT_FALSE(read_view_frame(bytes).has_value()) << "more robots than bytes";
}

TEST(FoxgloveSchemas, NeedNothingElse) {
  for (const std::string_view idl : {foxglove::kPosesInFrameIdl, foxglove::kSceneUpdateIdl}) {
    EXPECT_EQ(idl.find('#'), std::string_view::npos);
    EXPECT_EQ(std::count(idl.begin(), idl.end(), '{'), std::count(idl.begin(), idl.end(), '}'));
  }
}

class FoxgloveClient : public ::testing::Test {
 protected:
  Outgoing next() {
    Outgoing out;
    EXPECT_TRUE(session_.next(out));
    return out;
  }
  nlohmann::json next_json() { return nlohmann::json::parse(text_of(next())); }
  void greet() {
    next();
    next();
  }
  void step(Duration later = Duration(0)) {
    FoxgloveSession* const sessions[] = {&session_};
    feed_.step(kNow + later, sessions);
  }

  FakeViewSource source_;
  ViewCounters counters_;
  FoxgloveFeed feed_{source_};
  FoxgloveSession session_{feed_.channels(), "s1",
                           [this](std::uint32_t channel) { return feed_.newest(channel); },
                           counters_};
};

TEST_F(FoxgloveClient, ReceivesServerInfoAndChannels) {
  const auto info = next_json();
  EXPECT_EQ(info["op"], "serverInfo");
  EXPECT_EQ(info["capabilities"], nlohmann::json::array({"time"}));
  EXPECT_EQ(info["supportedEncodings"], nlohmann::json::array({"cdr"}));
  EXPECT_EQ(info["sessionId"], "s1");
  auto advertise = next_json();
  EXPECT_EQ(advertise["op"], "advertise");
  ASSERT_EQ(advertise["channels"].size(), 4U);
  EXPECT_EQ(advertise["channels"][3]["id"], 3);
  EXPECT_EQ(advertise["channels"][3]["topic"], "swarm/plan");
  EXPECT_EQ(advertise["channels"][3]["schemaName"], "swarm::wire::FlowPlan");
  EXPECT_EQ(advertise["channels"][3]["schemaEncoding"], "omgidl");
  EXPECT_EQ(advertise["channels"][0]["schemaName"], "foxglove::PosesInFrame");
  EXPECT_FALSE(session_.has_something());

  source_.channels.push_back({"later", "T", "struct T {};"});
  step();
  advertise = next_json();
  ASSERT_EQ(advertise["channels"].size(), 1U);
  EXPECT_EQ(advertise["channels"][0]["id"], 4);
}

TEST_F(FoxgloveClient, GetsTheNewestSampleOfWhatItSubscribed) {
  greet();
  source_.publish(0, "before");
  session_.take(R"({"op":"subscribe","subscriptions":[{"id":42,"channelId":3}]})", false);
  const auto latched = next();
  EXPECT_TRUE(latched.binary);
  const std::string bytes = text_of(latched);
  ASSERT_EQ(bytes.size(), 13U + 6U);
  EXPECT_EQ(bytes.substr(0, 5), std::string("\x01\x2A\0\0\0", 5));
  EXPECT_EQ(bytes.substr(5, 8), std::string("\x4D\0\0\0\0\0\0\0", 8));
  EXPECT_EQ(bytes.substr(13), "before");

  for (const char* sample : {"one", "two", "three"}) {
    source_.publish(0, sample);
    step();
  }
  EXPECT_EQ(counters_.samples_skipped, 2U);
  EXPECT_EQ(text_of(next())[0], 2) << "the time";
  EXPECT_EQ(text_of(next()).substr(13), "three");
  EXPECT_FALSE(session_.has_something());

  session_.take(R"({"op":"unsubscribe","subscriptionIds":[42]})", false);
  source_.publish(0, "four");
  step();
  EXPECT_FALSE(session_.has_something());
}

TEST_F(FoxgloveClient, GetsFramesTenTimesASecondWhileSubscribed) {
  greet();
  step();
  EXPECT_TRUE(source_.asked.empty()) << "no client subscribed";
  session_.take(
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0},{"id":2,"channelId":2}]})",
      false);
  for (int ms = 0; ms < 1000; ms += 10) step(std::chrono::milliseconds(ms));
  EXPECT_EQ(source_.asked.size(), 9U) << "the first step was taken before";
  std::multiset<int> kinds;
  while (session_.has_something()) kinds.insert(static_cast<int>(next().bytes[0]));
  EXPECT_EQ(kinds, (std::multiset<int>{1, 1, 2})) << "the newest of each, and the time";
}

TEST_F(FoxgloveClient, GetsObstaclesAtOnceAndOnChange) {
  greet();
  step();
  while (session_.has_something()) next();
  session_.take(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})", false);
  EXPECT_EQ(text_of(next())[0], 1);
  EXPECT_FALSE(session_.has_something());
  source_.scene_texts.emplace_back(R"({"obstacles":[]})");
  step();
  EXPECT_EQ(text_of(next())[0], 1);
}

TEST_F(FoxgloveClient, ReceivesAnErrorForEachMistake) {
  greet();
  const std::vector<std::string> wrong = {
      "",
      "[]",
      R"({"op":"fly"})",
      R"({"op":"subscribe"})",
      R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":0}]})",
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]})",
      R"({"op":"subscribe","subscriptions":[7]})",
      R"({"op":"unsubscribe","subscriptionIds":[9]})",
      R"({"op":"unsubscribe","subscriptionIds":["a"]})"};
  for (const std::string& frame : wrong) {
    session_.take(frame, false);
    const auto status = next_json();
    EXPECT_EQ(status["op"], "status") << frame;
    EXPECT_EQ(status["level"], 2) << frame;
  }
  session_.take("\x01 message", true);
  EXPECT_EQ(next_json()["level"], 2);
  EXPECT_EQ(counters_.frames_refused, wrong.size() + 1);
  session_.take(R"({"op":"advertise","channels":[]})", false);
  EXPECT_EQ(next_json()["level"], 1) << "not wrong, but not for us";
  EXPECT_EQ(counters_.frames_refused, wrong.size() + 1);
}

TEST_F(FoxgloveClient, MaySendAnything) {
  greet();
  FrameMutator mutator(11, {R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":3}]})",
                            R"({"op":"unsubscribe","subscriptionIds":[1]})",
                            R"({"op":"getParameters","parameterNames":["a"]})"});
  Outgoing out;
  for (int i = 0; i < 20'000; ++i) {
    session_.take(mutator.next(), mutator.chance(0.05));
    if (mutator.chance(0.1)) source_.publish(0, "sample");
    if (mutator.chance(0.1)) step(std::chrono::milliseconds(i));
    if (mutator.chance(0.5)) session_.next(out);
  }
  EXPECT_GT(counters_.frames_refused, 1'000U);
}

}  // namespace
}  // namespace swarm::monitor
