// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <string>
#include <string_view>
#include <vector>

#include "swarmflow/core/result.hpp"

/// The part of YAML that a mission file needs: a tree in which every node has its position.
namespace swarm::yaml {

/// Position in a file; line and column count from 1. The default is the begin of the file.
struct Position {
  int line = 1;
  int column = 1;
  auto operator<=>(const Position&) const = default;
};

struct Entry;

/// A value: empty, a scalar, a sequence or a mapping. A template, so that its members may be of a
/// type that contains it (clang 14 accepts no other form with default values).
template <class MapEntry>
struct NodeOf {
  enum class Kind { kNull, kScalar, kSequence, kMap };
  Kind kind = Kind::kNull;
  Position at;
  std::string text{};               ///< of a scalar
  bool plain = false;               ///< scalar without quotes: may be a number
  std::vector<NodeOf> items{};      ///< of a sequence
  std::vector<MapEntry> entries{};  ///< of a map, in order of the file; keys may repeat
};
using Node = NodeOf<Entry>;

/// A key of a mapping with its value.
struct Entry {
  std::string key;
  Position at;
  Node value;
};

/// `a mapping`, `a list`, `the text "abc"`, `100`, `empty`: what a node is, for messages.
std::string describe(const Node& node);

/// Bounds of a document, which protect memory and stack.
inline constexpr int kMaxDepth = 16;
inline constexpr std::size_t kMaxNodes = 1'000'000;

/// The mistake at which the parser stopped, and its position.
struct ParseError {
  Position at;
  std::string what;
};

/// Parses one document. Refuses features that a mission does not need and an attacker could use:
/// anchors and aliases, tags, several documents, keys that are not scalars, nesting beyond
/// kMaxDepth and more than kMaxNodes nodes. Never throws.
tl::expected<Node, ParseError> parse(std::string_view text);

}  // namespace swarm::yaml
