// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/yaml_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::yaml {
namespace {

Node parsed(std::string_view text) { return parse(text).value(); }

Node plain(std::string text) {
  return {.kind = Node::Kind::kScalar, .at = {4, 2}, .text = std::move(text), .plain = true};
}

std::string message_of(const Violations& violations) { return violations.to_error("f").message; }

/// The message with which read_number() refuses a value in [0, 10]; empty if it accepts it.
std::string refusal(const Node& node, const Range& range = between(0, 10)) {
  Violations violations;
  const auto number = read_number(node, "a.b", range, violations);
  EXPECT_EQ(number.has_value(), violations.empty());
  return message_of(violations);
}

TEST(MapReader, ReadsAKeyUnderItsFormerName) {
  Violations violations;
  const Node old_key = parsed("hear_radius_m: 4");
  MapReader former(old_key, "link", violations);
  const Node* const value = former.take("communication_radius_m");
  ASSERT_NE(value, nullptr);
  EXPECT_EQ(value->text, "4");
  former.finish();
  EXPECT_TRUE(violations.empty());

  const Node two_keys = parsed("{hear_radius_m: 4, communication_radius_m: 5}");
  MapReader both(two_keys, "link", violations);
  EXPECT_EQ(both.take("communication_radius_m")->text, "5");
  both.finish();
  EXPECT_NE(message_of(violations).find("unknown key link.hear_radius_m"), std::string::npos);
}

TEST(Violations, AreReportedInOrderOfTheFile) {
  Violations violations;
  EXPECT_TRUE(violations.empty());
  violations.add({3, 1}, "third");
  violations.add({1, 9}, "second");
  violations.add({1, 2}, "first");
  violations.add({3, 1}, "fourth, found after the third");

  EXPECT_FALSE(violations.empty());
  const Error error = violations.to_error("m.yaml");
  EXPECT_EQ(error.code, ErrorCode::kBadInput);
  EXPECT_EQ(error.message,
            "m.yaml:1:2: first\nm.yaml:1:9: second\nm.yaml:3:1: third\n"
            "m.yaml:3:1: fourth, found after the third");
}

TEST(Violations, HaveNoControlCharacters) {
  Violations violations;
  violations.add({}, "a\nb\x1b[31mc\x7f\xc3\xa9");

  EXPECT_EQ(message_of(violations), "f:1:1: a b [31mc \xc3\xa9");
}

TEST(Violations, AreReportedUpToAThousand) {
  Violations violations;
  for (int i = 1; i <= 1000; ++i) violations.add({i, 1}, "x");
  EXPECT_EQ(message_of(violations).find("more"), std::string::npos);
  violations.add({1001, 1}, "x");
  violations.add({1002, 1}, "x");

  EXPECT_TRUE(message_of(violations).ends_with("\nf:1000:1: x\n... and 2 more"));
}

TEST(MapReader, ReportsKeysThatAreMissingTwiceOrUnknown) {
  const Node node = parsed("gain_hz: 1\nradius_m: 2\ngain_hz: 3\nradios_m: 4\nxyzzy: 5\n");
  Violations violations;
  MapReader keys(node, "control", violations);

  const Node* gain = keys.take("gain_hz");
  ASSERT_NE(gain, nullptr);
  EXPECT_EQ(gain->text, "1");  // of a key that is given twice the first value counts
  EXPECT_NE(keys.take("radius_m", true), nullptr);
  EXPECT_EQ(keys.take("speed_mps"), nullptr);
  EXPECT_EQ(keys.take("mass_kg", true), nullptr);
  keys.finish();

  EXPECT_EQ(message_of(violations),
            "f:1:1: control.mass_kg is missing; add it\n"
            "f:3:1: control.gain_hz is given twice; remove it here or in line 1\n"
            "f:4:1: unknown key control.radios_m; did you mean control.radius_m?\n"
            "f:5:1: unknown key control.xyzzy; known here: gain_hz, radius_m, speed_mps, mass_kg");
}

TEST(MapReader, HandsOutEachValueOnce) {
  const Node node = parsed("{a: 1}");
  Violations violations;
  MapReader keys(node, "", violations);

  EXPECT_NE(keys.take("a"), nullptr);
  EXPECT_EQ(keys.take("a"), nullptr);
  keys.finish();
  EXPECT_TRUE(violations.empty());
}

// One mistake gives one message: what the mapping would have to hold is not reported as well.
TEST(MapReader, ReportsAValueThatIsNoMappingOnce) {
  for (const auto& [text, is] : {std::pair{"[1]", "a list"}, {"7", "\"7\""}, {"~", "empty"}}) {
    for (const auto& [path, name] : {std::pair{"world", "world"}, {"", "the mission"}}) {
      const Node node = parsed(text);
      Violations violations;
      MapReader keys(node, path, violations);

      EXPECT_FALSE(keys.is_map());
      EXPECT_EQ(keys.take("bounds_m", true), nullptr);
      EXPECT_TRUE(keys.take_scalars().empty());
      keys.finish();
      EXPECT_EQ(message_of(violations),
                fmt::format("f:1:1: {} is {}; must be a mapping of keys to values", name, is));
    }
  }
}

TEST(MapReader, LeavesListsAndMappingsWhenItTakesAllScalars) {
  const Node node = parsed("{b: 1, list: [1], a: text, map: {x: 1}, none: ~, taken: 2}");
  Violations violations;
  MapReader keys(node, "", violations);
  keys.take("taken");

  const auto scalars = keys.take_scalars();

  ASSERT_EQ(scalars.size(), 2U);
  EXPECT_EQ(scalars[0].first + scalars[1].first, "ab");
  EXPECT_EQ(scalars[0].second->text, "text");
  EXPECT_NE(keys.take("list"), nullptr);
  EXPECT_NE(keys.take("map"), nullptr);
  EXPECT_NE(keys.take("none"), nullptr);
}

TEST(ReadNumber, AcceptsDecimalsWithinTheRangeAlone) {
  for (const std::string text : {"0", "10", "-0", "+1", "1.", ".5", "1e0", "1E+1", "+.5e1"}) {
    EXPECT_EQ(refusal(plain(text)), "") << text;
  }
  for (const std::string text : {"", "+", "-", ".", "e1", "1e", "0x5", "1 m", "5m", "1_0", "1,5",
                                 "++1", "+-1", "--1", "1e0.5", "one", "true", "5 "}) {
    EXPECT_EQ(refusal(plain(text)), fmt::format("f:4:2: a.b is \"{}\", no number; must be >= 0 "
                                                "and <= 10",
                                                text));
  }
  for (const std::string text : {".nan", "nan", "-.NaN", ".inf", "+.Inf", "-infinity", "INF"}) {
    EXPECT_EQ(refusal(plain(text)), "f:4:2: a.b is not finite; must be >= 0 and <= 10") << text;
  }
  EXPECT_EQ(refusal(plain("1e999")),
            "f:4:2: a.b is \"1e999\", beyond any number; must be >= 0 and <= 10");
  EXPECT_EQ(refusal(plain("10.5")), "f:4:2: a.b is 10.5; must be >= 0 and <= 10");
  EXPECT_EQ(refusal(plain("-1e-300")), "f:4:2: a.b is -1e-300; must be >= 0 and <= 10");
  EXPECT_EQ(refusal(plain("0"), positive(2)), "f:4:2: a.b is 0; must be > 0 and <= 2");
}

TEST(ReadNumber, RefusesWhatIsNoPlainScalar) {
  for (const auto& [text, is] : {std::pair{"\"1\"", "\"1\""},
                                 {"'1'", "\"1\""},
                                 {"[1]", "a list"},
                                 {"{a: 1}", "a mapping"},
                                 {"~", "empty"}}) {
    EXPECT_EQ(refusal(parsed(text)),
              fmt::format("f:1:1: a.b is {}, no number; must be >= 0 and <= 10", is));
  }
}

TEST(ReadNumber, ReadsEveryDoubleBackBitForBit) {
  constexpr double kMax = std::numeric_limits<double>::max();
  Rng rng(3);
  Violations violations;
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t bits = rng();
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;

    const auto read =
        read_number(plain(fmt::format("{}", value)), "x", between(-kMax, kMax), violations);

    ASSERT_TRUE(read.has_value()) << value;
    EXPECT_EQ(std::memcmp(&*read, &value, sizeof value), 0) << value;
  }
}

TEST(ReadCount, AcceptsWholeNumbersOfThirtyTwoBits) {
  const Range all = between(0, 4294967295.0);
  Violations violations;

  EXPECT_EQ(read_count(plain("0"), "n", all, violations), 0U);
  EXPECT_EQ(read_count(plain("1e3"), "n", all, violations), 1000U);
  EXPECT_EQ(read_count(plain("4294967295"), "n", all, violations), 4294967295U);
  EXPECT_TRUE(violations.empty());
  EXPECT_FALSE(read_count(plain("4294967296"), "n", all, violations).has_value());
  EXPECT_FALSE(read_count(plain("-1"), "n", all, violations).has_value());
  EXPECT_FALSE(read_count(plain("2.5"), "n", all, violations).has_value());
  EXPECT_TRUE(message_of(violations).ends_with("f:4:2: n is 2.5; must be a whole number"));
}

TEST(ReadChoice, NamesTheKnownValues) {
  constexpr std::array<std::string_view, 2> kKnown{"apf", "crops"};
  Violations violations;

  EXPECT_EQ(read_choice(plain("crops"), "m", kKnown, violations), "crops");
  EXPECT_TRUE(violations.empty());
  EXPECT_EQ(read_choice(plain("Apf"), "m", kKnown, violations), std::nullopt);
  EXPECT_EQ(read_choice(parsed("[apf]"), "m", kKnown, violations), std::nullopt);
  EXPECT_EQ(message_of(violations),
            "f:1:1: m is a list; must be text\nf:4:2: m is \"Apf\"; must be one of: apf, crops");
}

TEST(ReadNumbers, ReportsEveryWrongNumberWithItsIndex) {
  Violations violations;
  EXPECT_EQ(read_numbers(parsed("[1, 2]"), "p", 2, between(0, 5), violations),
            (std::vector<double>{1, 2}));
  EXPECT_TRUE(violations.empty());
  EXPECT_FALSE(read_numbers(parsed("[6, 1, x]"), "p", 3, between(0, 5), violations));
  EXPECT_FALSE(read_numbers(parsed("\n[1, 2, 3]"), "p", 2, between(0, 5), violations));
  EXPECT_FALSE(read_numbers(parsed("\n\n5"), "p", 2, between(0, 5), violations));

  EXPECT_EQ(message_of(violations),
            "f:1:2: p[0] is 6; must be >= 0 and <= 5\n"
            "f:1:8: p[2] is \"x\", no number; must be >= 0 and <= 5\n"
            "f:2:1: p is a list of 3; must be a list of 2 numbers\n"
            "f:3:1: p is \"5\"; must be a list of 2 numbers");
}

TEST(ReadList, AcceptsSizesBetweenItsBounds) {
  for (std::size_t size = 0; size <= 5; ++size) {
    const Node node{.kind = Node::Kind::kSequence, .at = {}, .items = std::vector<Node>(size)};
    Violations violations;

    const auto* items = read_list(node, "l", 1, 4, violations);

    const bool fits = size >= 1 && size <= 4;
    EXPECT_EQ(items, fits ? &node.items : nullptr);
    EXPECT_EQ(message_of(violations),
              fits ? "" : fmt::format("f:1:1: l has {} items; must have between 1 and 4", size));
  }
}

/// Levenshtein distance by its recursive definition.
std::size_t edits(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  const std::size_t rest = edits(a.substr(1), b.substr(1));
  if (a[0] == b[0]) return rest;
  return 1 + std::min({rest, edits(a.substr(1), b), edits(a, b.substr(1))});
}

TEST(NearestKey, IsTheFirstOfTheFewestEditsIfFewEnough) {
  Rng rng(11);
  const auto text = [&] {
    std::string letters(rng() % 7, 'a');
    for (char& c : letters) c = static_cast<char>('a' + rng() % 3);
    return letters;
  };
  for (int round = 0; round < 300; ++round) {
    const std::string key = text();
    const std::vector<std::string> candidates{text(), text(), text(), text()};
    std::optional<std::string> best;
    std::size_t fewest = std::max<std::size_t>(2, key.size() / 3) + 1;
    for (const std::string& candidate : candidates) {
      if (edits(key, candidate) >= fewest) continue;
      fewest = edits(key, candidate);
      best = candidate;
    }

    EXPECT_EQ(nearest_key(key, candidates), best) << key;
  }
  EXPECT_EQ(nearest_key("a", {}), std::nullopt);
  // The effort for a long key is bounded.
  EXPECT_EQ(nearest_key(std::string(80, 'x'), {std::string(80, 'x')}), std::string(80, 'x'));
  EXPECT_EQ(nearest_key(std::string(81, 'x'), {std::string(81, 'x')}), std::nullopt);
}

}  // namespace
}  // namespace swarm::yaml
