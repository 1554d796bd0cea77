// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/yaml_reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace swarm::yaml {
namespace {

/// Violations that are reported at most: a hostile file must not fill the terminal.
constexpr std::size_t kMaxReported = 1000;

/// A key of missions of version 0.1 under its former name, which is still read.
constexpr std::string_view kFormerKey = "hear_radius_m";
constexpr std::string_view kRenamedKey = "communication_radius_m";

/// Levenshtein distance with one row of the dynamic programme; O(|a| · |b|).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

/// Whether a text is one of YAML's spellings of NaN and infinity, some of which from_chars accepts.
bool is_not_finite(std::string_view text) {
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  if (!text.empty() && text[0] == '.') text.remove_prefix(1);
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return lower == "nan" || lower == "inf" || lower == "infinity";
}

}  // namespace

void Violations::add(Position at, std::string what_and_what_instead) {
  // Quoted parts of the file must not break the line or send control characters to the terminal.
  for (char& c : what_and_what_instead) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  all_.emplace_back(at, std::move(what_and_what_instead));
}

/// Sorted by position, since sections are read in an order of their own.
Error Violations::to_error(const std::string& file) const {
  std::vector<std::pair<Position, std::string>> sorted = all_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  const std::size_t shown = std::min(sorted.size(), kMaxReported);
  std::string message;
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& [at, text] = sorted[i];
    message += fmt::format("{}{}:{}:{}: {}", i == 0 ? "" : "\n", file, at.line, at.column, text);
  }
  if (shown < sorted.size()) message += fmt::format("\n... and {} more", sorted.size() - shown);
  return {ErrorCode::kBadInput, std::move(message)};
}

/// Of a key given twice the first value counts, and the second is the violation.
MapReader::MapReader(const Node& node, std::string path, Violations& violations)
    : path_(std::move(path)), at_(node.at), violations_(violations) {
  is_map_ = node.kind == Node::Kind::kMap;
  if (!is_map_) {
    violations_.add(at_, fmt::format("{} is {}; must be a mapping of keys to values",
                                     path_.empty() ? "the mission" : path_, describe(node)));
    return;
  }
  for (const Entry& entry : node.entries) {
    const auto [first, is_new] = entries_.emplace(entry.key, &entry);
    if (is_new) continue;
    violations_.add(entry.at, fmt::format("{} is given twice; remove it here or in line {}",
                                          path_of(entry.key), first->second->at.line));
  }
}

std::string MapReader::path_of(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

/// A taken key is removed, so that finish() finds the unknown ones. Every key asked for is
/// remembered for "did you mean".
const Node* MapReader::take(std::string_view key, bool required) {
  known_.emplace_back(key);
  auto it = entries_.find(key);
  if (it == entries_.end() && key == kRenamedKey) it = entries_.find(kFormerKey);
  if (it != entries_.end()) {
    const Node* value = &it->second->value;
    entries_.erase(it);
    return value;
  }
  if (required && is_map_) {
    violations_.add(at_, fmt::format("{} is missing; add it", path_of(key)));
  }
  return nullptr;
}

std::vector<std::pair<std::string, const Node*>> MapReader::take_scalars() {
  std::vector<std::pair<std::string, const Node*>> scalars;
  std::erase_if(entries_, [&](const auto& item) {
    const Node& value = item.second->value;
    if (value.kind != Node::Kind::kScalar) return false;
    scalars.emplace_back(std::string(item.first), &value);
    return true;
  });
  return scalars;
}

/// A key that is far from every known one gets the list of known keys instead of a suggestion.
void MapReader::finish() {
  for (const auto& [key, entry] : entries_) {
    const std::optional<std::string> nearest = nearest_key(key, known_);
    violations_.add(entry->at,
                    nearest ? fmt::format("unknown key {}; did you mean {}?",
                                          path_of(key.substr(0, 80)), path_of(*nearest))
                            : fmt::format("unknown key {}; known here: {}",
                                          path_of(key.substr(0, 80)), fmt::join(known_, ", ")));
  }
  entries_.clear();
}

/// Strict: no quotes, no hexadecimal, no units, no trailing characters, nothing that is not finite.
std::optional<double> read_number(const Node& node, const std::string& path, const Range& range,
                                  Violations& violations) {
  const auto refuse = [&](std::string_view what) {
    violations.add(node.at, fmt::format("{} {}; {}", path, what, to_string(range)));
    return std::nullopt;
  };
  if (node.kind != Node::Kind::kScalar || !node.plain) {
    return refuse(fmt::format("is {}, no number", describe(node)));
  }
  if (is_not_finite(node.text)) return refuse("is not finite");
  std::string_view digits = node.text;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range && end == digits.data() + digits.size()) {
    return refuse(fmt::format("is {}, beyond any number", describe(node)));
  }
  if (error != std::errc{} || end != digits.data() + digits.size()) {
    return refuse(fmt::format("is {}, no number", describe(node)));
  }
  if (!range.contains(value)) return refuse(fmt::format("is {}", value));
  return value;
}

std::optional<std::uint32_t> read_count(const Node& node, const std::string& path,
                                        const Range& range, Violations& violations) {
  const std::optional<double> value = read_number(node, path, range, violations);
  if (!value) return std::nullopt;
  if (*value != std::floor(*value)) {
    violations.add(node.at, fmt::format("{} is {}; must be a whole number", path, *value));
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(*value);
}

std::optional<std::string> read_text(const Node& node, const std::string& path,
                                     Violations& violations) {
  if (node.kind == Node::Kind::kScalar) return node.text;
  violations.add(node.at, fmt::format("{} is {}; must be text", path, describe(node)));
  return std::nullopt;
}

std::optional<std::string> read_choice(const Node& node, const std::string& path,
                                       std::span<const std::string_view> known,
                                       Violations& violations) {
  auto chosen = read_text(node, path, violations);
  if (!chosen || std::find(known.begin(), known.end(), *chosen) != known.end()) return chosen;
  violations.add(node.at, fmt::format("{} is {}; must be one of: {}", path, describe(node),
                                      fmt::join(known, ", ")));
  return std::nullopt;
}

std::optional<std::string> read_printable(const Node& node, const std::string& path,
                                          std::size_t most, Violations& violations) {
  auto text = read_text(node, path, violations);
  const auto is_printable = [](char c) { return c >= 0x20 && c < 0x7F && c != '"' && c != '\\'; };
  if (!text || (text->size() <= most && std::all_of(text->begin(), text->end(), is_printable))) {
    return text;
  }
  violations.add(
      node.at, fmt::format("{} must have at most {} characters of ASCII, no quotes or backslashes",
                           path, most));
  return std::nullopt;
}

/// Every wrong number of the list is reported, with its index in the path.
std::optional<std::vector<double>> read_numbers(const Node& node, const std::string& path,
                                                std::size_t size, const Range& range,
                                                Violations& violations) {
  if (node.kind != Node::Kind::kSequence || node.items.size() != size) {
    const std::string is = node.kind == Node::Kind::kSequence
                               ? fmt::format("a list of {}", node.items.size())
                               : describe(node);
    violations.add(node.at, fmt::format("{} is {}; must be a list of {} numbers", path, is, size));
    return std::nullopt;
  }
  std::vector<double> numbers;
  for (std::size_t i = 0; i < size; ++i) {
    const auto number =
        read_number(node.items[i], fmt::format("{}[{}]", path, i), range, violations);
    if (number) numbers.push_back(*number);
  }
  if (numbers.size() != size) return std::nullopt;
  return numbers;
}

const std::vector<Node>* read_list(const Node& node, const std::string& path, std::size_t min_size,
                                   std::size_t max_size, Violations& violations) {
  if (node.kind != Node::Kind::kSequence) {
    violations.add(node.at, fmt::format("{} is {}; must be a list", path, describe(node)));
    return nullptr;
  }
  if (node.items.size() < min_size || node.items.size() > max_size) {
    violations.add(node.at, fmt::format("{} has {} items; must have between {} and {}", path,
                                        node.items.size(), min_size, max_size));
    return nullptr;
  }
  return &node.items;
}

std::optional<std::string> nearest_key(std::string_view key,
                                       const std::vector<std::string>& candidates) {
  if (key.size() > 80) return std::nullopt;
  std::optional<std::string> best;
  // Up to a third of the letters may be mistyped; with more the key is probably not meant.
  std::size_t best_distance = std::max<std::size_t>(2, key.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(key, candidate);
    if (distance >= best_distance) continue;
    best_distance = distance;
    best = candidate;
  }
  return best;
}

}  // namespace swarm::yaml
