// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/yaml_tree.hpp"

#include <istream>
#include <optional>
#include <streambuf>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

namespace swarm::yaml {
namespace {

Position position_of(const YAML::Mark& mark) {
  // A null mark is (-1, -1).
  return {.line = mark.line < 0 ? 1 : mark.line + 1,
          .column = mark.column < 0 ? 1 : mark.column + 1};
}

/// Leaves yaml-cpp's parser from inside an event; caught in parse().
struct Refusal {
  ParseError error;
};

[[noreturn]] void refuse(const YAML::Mark& mark, std::string what) {
  throw Refusal{{position_of(mark), std::move(what)}};
}

/// Builds the tree from yaml-cpp's events rather than from its Node, because Node follows aliases,
/// merges duplicate keys in look-ups and does not bound its size.
class TreeBuilder final : public YAML::EventHandler {
 public:
  Node root;

  // yaml-cpp calls these functions in the order of the file; refuse() leaves the parser at once.
  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) refuse(mark, "a second document; a mission file holds one");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    check(mark, "", anchor);
    place(mark, Node{.kind = Node::Kind::kNull, .at = position_of(mark)});
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse(mark, "an alias; write the value out");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    check(mark, tag, anchor);
    place(mark, Node{.kind = Node::Kind::kScalar,
                     .at = position_of(mark),
                     .text = value,
                     .plain = tag != "!"});
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, Node::Kind::kSequence);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, Node::Kind::kMap);
  }
  void OnMapEnd() override { close(); }
  void OnAnchor(const YAML::Mark& mark, const std::string&) override { refuse_anchor(mark); }

 private:
  struct Level {
    Node node;
    bool has_key = false;
    Entry entry{};
  };

  [[noreturn]] static void refuse_anchor(const YAML::Mark& mark) {
    refuse(mark, "an anchor; write the value out where it is used");
  }

  /// "?" is yaml-cpp's tag for a plain node, "!" for a quoted one.
  void check(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    if (anchor != 0) refuse_anchor(mark);
    if (!tag.empty() && tag != "?" && tag != "!") refuse(mark, "a tag; mission files have none");
    if (++nodes_ > kMaxNodes) {
      refuse(mark, fmt::format("more than {} values; the file is too large", kMaxNodes));
    }
  }

  // Enters a sequence or mapping. The depth is bounded because the tree is destroyed recursively.
  void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
            Node::Kind kind) {
    check(mark, tag, anchor);
    if (!levels_.empty() && is_key_next())
      refuse(mark, "a key that is not text; keys are plain text");
    if (levels_.size() >= static_cast<std::size_t>(kMaxDepth)) {
      refuse(mark, fmt::format("nested deeper than {} levels", kMaxDepth));
    }
    levels_.push_back({.node = Node{.kind = kind, .at = position_of(mark)}});
  }

  // A complete sequence or mapping becomes a value of the level around it.
  void close() {
    Node done = std::move(levels_.back().node);
    levels_.pop_back();
    add(std::move(done));
  }

  bool is_key_next() const {
    return levels_.back().node.kind == Node::Kind::kMap && !levels_.back().has_key;
  }

  // A scalar is a key or a value, depending on what its mapping expects next.
  void place(const YAML::Mark& mark, Node node) {
    if (!levels_.empty() && is_key_next()) {
      if (node.kind != Node::Kind::kScalar) refuse(mark, "an empty key; keys are plain text");
      levels_.back().entry = {.key = std::move(node.text), .at = node.at, .value = {}};
      levels_.back().has_key = true;
      return;
    }
    add(std::move(node));
  }

  // Adds a value to the innermost open level; without one it is the document itself.
  void add(Node node) {
    if (levels_.empty()) {
      root = std::move(node);
      return;
    }
    Level& level = levels_.back();
    if (level.node.kind == Node::Kind::kSequence) {
      level.node.items.push_back(std::move(node));
      return;
    }
    // yaml-cpp gives an empty value the position of the text after it.
    if (node.kind == Node::Kind::kNull) node.at = level.entry.at;
    level.entry.value = std::move(node);
    level.node.entries.push_back(std::move(level.entry));
    level.has_key = false;
  }

  std::vector<Level> levels_;
  std::size_t nodes_ = 0;
  int documents_ = 0;
};

/// A stream over the caller's bytes, without a copy.
class ViewBuffer final : public std::streambuf {
 public:
  explicit ViewBuffer(std::string_view text) {
    // std::streambuf requires char*, but this buffer never writes.
    char* begin = const_cast<char*>(text.data());
    setg(begin, begin, begin + text.size());
  }
};

/// Where brackets are nested deeper than in any mission. The parser keeps all tokens from the first
/// open bracket on: a file of them would take gigabytes before the limit of depth is seen.
/// Brackets in quotes and comments count, too, but close there as well in any text of people.
std::optional<Position> too_many_brackets(std::string_view text) {
  constexpr int kMost = 1000;
  int open = 0;
  Position at;
  for (const char c : text) {
    if (c == '[' || c == '{') ++open;
    if ((c == ']' || c == '}') && open > 0) --open;
    if (open > kMost) return at;
    at = c == '\n' ? Position{at.line + 1, 1} : Position{at.line, at.column + 1};
  }
  return std::nullopt;
}

}  // namespace

/// Long texts are cut: a message must fit a line.
std::string describe(const Node& node) {
  switch (node.kind) {
    case Node::Kind::kNull:
      return "empty";
    case Node::Kind::kSequence:
      return "a list";
    case Node::Kind::kMap:
      return "a mapping";
    case Node::Kind::kScalar:
      break;
  }
  constexpr std::size_t kShown = 40;
  const bool cut = node.text.size() > kShown;
  return fmt::format("\"{}{}\"", node.text.substr(0, kShown), cut ? "..." : "");
}

/// The only place where exceptions of yaml-cpp end.
tl::expected<Node, ParseError> parse(std::string_view text) {
  // A NUL ends yaml-cpp's stream silently: what follows would be ignored.
  if (const std::size_t nul = text.find('\0'); nul != std::string_view::npos) {
    Position at;
    for (const char c : text.substr(0, nul)) {
      at = c == '\n' ? Position{at.line + 1, 1} : Position{at.line, at.column + 1};
    }
    return tl::unexpected(ParseError{at, "a NUL byte; mission files are UTF-8 text"});
  }
  if (const auto at = too_many_brackets(text)) {
    return tl::unexpected(ParseError{*at, "too many brackets are open"});
  }
  try {
    ViewBuffer buffer(text);
    std::istream stream(&buffer);
    YAML::Parser parser(stream);
    TreeBuilder builder;
    while (parser.HandleNextDocument(builder)) {
    }
    return std::move(builder.root);
  } catch (const Refusal& refusal) {
    return tl::unexpected(refusal.error);
  } catch (const YAML::Exception& exception) {
    return tl::unexpected(
        ParseError{position_of(exception.mark), "no valid YAML: " + exception.msg});
  } catch (const std::exception& exception) {
    return tl::unexpected(ParseError{{}, fmt::format("cannot be parsed: {}", exception.what())});
  }
}

}  // namespace swarm::yaml
