// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <string>
#include <string_view>
#include <vector>

#include "swarmflow/core/result.hpp"

/// YAML as far as a mission file needs it: a tree in which every node knows where it stands.
namespace swarm::yaml {

/// Place in a file, both counted from 1. The default sorts before every real one.
struct Position {
  int line = 1;
  int column = 1;
  auto operator<=>(const Position&) const = default;
};

struct Entry;

struct Node {
  enum class Kind { kNull, kScalar, kSequence, kMap };
  Kind kind = Kind::kNull;
  Position at;
  std::string text{};            ///< of a scalar
  bool plain = false;            ///< scalar without quotes: may be a number
  std::vector<Node> items{};     ///< of a sequence
  std::vector<Entry> entries{};  ///< of a map, in order of the file; keys may repeat
};

struct Entry {
  std::string key;
  Position at;
  Node value;
};

/// `a mapping`, `a list`, `the text "abc"`, `100`, `empty`: what a node is, for messages.
std::string describe(const Node& node);

inline constexpr int kMaxDepth = 16;
inline constexpr std::size_t kMaxNodes = 1'000'000;

/// What stops the reader, with its place.
struct ParseError {
  Position at;
  std::string what;
};

/// Parses one document. Refuses what a mission has no use for and an attacker has: anchors and
/// aliases, tags, several documents, keys that are no scalars, nesting beyond kMaxDepth and more
/// than kMaxNodes nodes. Never throws.
tl::expected<Node, ParseError> parse(std::string_view text);

}  // namespace swarm::yaml
