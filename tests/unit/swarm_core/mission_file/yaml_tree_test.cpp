// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/yaml_tree.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::yaml {
namespace {

constexpr std::string_view kDocument = R"(name: demo
world:
  bounds_m: [0, -1.5, "20"]
  obstacles:
    - circle
    - {radius: 1}
empty:
last: ''
)";

Node parsed(std::string_view text) {
  auto node = parse(text);
  EXPECT_TRUE(node.has_value()) << node.error().what;
  return node.value_or(Node{});
}

TEST(YamlTree, GivesEveryValueItsKindAndPosition) {
  const Node root = parsed(kDocument);

  ASSERT_EQ(root.kind, Node::Kind::kMap);
  ASSERT_EQ(root.entries.size(), 4U);
  EXPECT_EQ(root.entries[0].key, "name");
  EXPECT_EQ(root.entries[0].value.text, "demo");
  EXPECT_EQ(root.entries[0].value.at, (Position{1, 7}));
  const Node& world = root.entries[1].value;
  ASSERT_EQ(world.entries.size(), 2U);
  EXPECT_EQ(world.entries[0].at, (Position{3, 3}));
  const Node& bounds = world.entries[0].value;
  ASSERT_EQ(bounds.kind, Node::Kind::kSequence);
  ASSERT_EQ(bounds.items.size(), 3U);
  EXPECT_EQ(bounds.at, (Position{3, 13}));
  EXPECT_EQ(bounds.items[1].text, "-1.5");
  EXPECT_EQ(bounds.items[1].at, (Position{3, 17}));
  const Node& obstacles = world.entries[1].value;
  ASSERT_EQ(obstacles.items.size(), 2U);
  EXPECT_EQ(obstacles.items[0].at, (Position{5, 7}));
  ASSERT_EQ(obstacles.items[1].kind, Node::Kind::kMap);
  EXPECT_EQ(obstacles.items[1].entries[0].value.at, (Position{6, 16}));
}

TEST(YamlTree, DistinguishesQuotedScalarsFromPlainOnes) {
  const Node root = parsed("[20, \"20\", '20', a b]");

  ASSERT_EQ(root.items.size(), 4U);
  EXPECT_TRUE(root.items[0].plain);
  EXPECT_FALSE(root.items[1].plain);
  EXPECT_FALSE(root.items[2].plain);
  EXPECT_TRUE(root.items[3].plain);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(root.items[i].text, "20");
}

TEST(YamlTree, PlacesAnEmptyValueAtItsKey) {
  const Node root = parsed(kDocument);

  ASSERT_EQ(root.entries.size(), 4U);
  EXPECT_EQ(root.entries[2].value.kind, Node::Kind::kNull);
  EXPECT_EQ(root.entries[2].value.at, (Position{7, 1}));
  // A quoted empty text is a text.
  EXPECT_EQ(root.entries[3].value.kind, Node::Kind::kScalar);
  EXPECT_EQ(root.entries[3].value.text, "");
}

TEST(YamlTree, OfATextWithoutValuesIsEmptyAtItsBegin) {
  for (const std::string_view text : {"", "\n\n", "# only a comment\n", "   "}) {
    const Node root = parsed(text);

    EXPECT_EQ(root.kind, Node::Kind::kNull) << text;
    EXPECT_EQ(root.at, Position{}) << text;
  }
}

// What a repeated key means is decided by the reader of the mapping.
TEST(YamlTree, KeepsRepeatedKeysInOrderOfTheFile) {
  const Node root = parsed("b: 1\na: 2\nb: 3\n");

  ASSERT_EQ(root.entries.size(), 3U);
  EXPECT_EQ(root.entries[0].key + root.entries[1].key + root.entries[2].key, "bab");
  EXPECT_EQ(root.entries[2].value.text, "3");
  EXPECT_EQ(root.entries[2].at, (Position{3, 1}));
}

TEST(YamlTree, RefusesWhatAMissionDoesNotNeed) {
  struct Case {
    std::string text;
    Position at;
    std::string what;
  };
  const Case cases[] = {
      {"a: 1\nb: &x 2\n", {2, 4}, "an anchor; write the value out where it is used"},
      {"a: [&x 2]\n", {1, 5}, "an anchor; write the value out where it is used"},
      {"a: !!int 2\n", {1, 4}, "a tag; mission files have none"},
      {"a: !mine {b: 1}\n", {1, 4}, "a tag; mission files have none"},
      {"a: 1\n---\nb: 2\n", {2, 1}, "a second document; a mission file holds one"},
      {"? [a, b]\n: 1\n", {1, 3}, "a key that is not text; keys are plain text"},
      {"{{a: 1}: 2}", {1, 2}, "a key that is not text; keys are plain text"},
      {"~: 1\n", {1, 1}, "an empty key; keys are plain text"},
      {"a: 1\nb: " + std::string(2000, '['), {2, 1004}, "too many brackets are open"},
      {std::string("a: 1\nbc\0d: 2", 12), {2, 3}, "a NUL byte; mission files are UTF-8 text"},
  };
  for (const auto& [text, at, what] : cases) {
    const auto tree = parse(text);

    ASSERT_FALSE(tree.has_value()) << text;
    EXPECT_EQ(tree.error().what, what) << text;
    EXPECT_EQ(tree.error().at.line, at.line) << text;
    EXPECT_EQ(tree.error().at.column, at.column) << text;
  }
}

TEST(YamlTree, ReportsWhereTheTextIsNoYaml) {
  for (const auto& [text, line] : {std::pair{"a: 1\nb: [2, 3\n", 3},
                                   {"a: 1\nb: }\n", 2},

                                   {"a: 1\n b: 2\n", 2}}) {
    const auto tree = parse(text);

    ASSERT_FALSE(tree.has_value()) << text;
    EXPECT_TRUE(tree.error().what.starts_with("no valid YAML: ")) << tree.error().what;
    EXPECT_EQ(tree.error().at.line, line) << text;
  }
}

TEST(YamlTree, IsAsDeepAsAllowedAndNoDeeper) {
  const auto nested = [](int depth) {
    const auto levels = static_cast<std::size_t>(depth);
    return std::string(levels, '[') + std::string(levels, ']');
  };

  EXPECT_TRUE(parse(nested(kMaxDepth)).has_value());
  const auto deeper = parse(nested(kMaxDepth + 1));
  ASSERT_FALSE(deeper.has_value());
  EXPECT_EQ(deeper.error().what, "nested deeper than 16 levels");
  EXPECT_EQ(deeper.error().at, (Position{1, kMaxDepth + 1}));
}

// Any text gives a tree or a mistake in the text, never an exception.
TEST(YamlTree, OfADamagedTextIsATreeOrAMistakeInTheText) {
  constexpr std::string_view kBytes = "\t\n -:,[]{}\"'#&*!|>%@?~\x80\xFF\\0a";
  Rng rng(7);
  for (int round = 0; round < 3000; ++round) {
    std::string text(kDocument);
    for (std::uint64_t i = rng() % 4 + 1; i > 0; --i) {
      text[rng() % text.size()] = kBytes[rng() % kBytes.size()];
    }
    if (round % 3 == 0) text.resize(rng() % text.size());

    const auto tree = parse(text);

    if (tree) continue;
    EXPECT_FALSE(tree.error().what.empty());
    EXPECT_GE(tree.error().at.column, 1);
    EXPECT_GE(tree.error().at.line, 1);
    EXPECT_LE(tree.error().at.line, std::count(text.begin(), text.end(), '\n') + 1) << text;
  }
}

TEST(YamlTree, DescribesNodesInAFewLetters) {
  const Node root =
      parsed("[{a: 1}, [1], ~, 1e3, " + std::string(40, 'x') + ", " + std::string(41, 'x') + "]");

  ASSERT_EQ(root.items.size(), 6U);
  EXPECT_EQ(describe(root.items[0]), "a mapping");
  EXPECT_EQ(describe(root.items[1]), "a list");
  EXPECT_EQ(describe(root.items[2]), "empty");
  EXPECT_EQ(describe(root.items[3]), "\"1e3\"");
  EXPECT_EQ(describe(root.items[4]), '"' + std::string(40, 'x') + '"');
  EXPECT_EQ(describe(root.items[5]), '"' + std::string(40, 'x') + "...\"");
}

}  // namespace
}  // namespace swarm::yaml
