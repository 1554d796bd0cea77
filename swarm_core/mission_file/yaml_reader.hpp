// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "swarm_core/mission_file/yaml_tree.hpp"
#include "swarmflow/mission/options.hpp"

namespace swarm::yaml {

/// Collects all mistakes of a file.
class Violations {
 public:
  /// Adds a violation; control characters in the text become spaces.
  void add(Position at, std::string what_and_what_instead);
  bool empty() const { return all_.empty(); }

  /// All of them, one per line as `file:line:column: …`, in order of the file.
  Error to_error(const std::string& file) const;

 private:
  std::vector<std::pair<Position, std::string>> all_;
};

using swarm::Range;

/// Reads the keys of one mapping strictly: each known key may be given at most once, and an unknown
/// key is a violation that names the nearest known one. Messages name values by their paths, such
/// as `link.communication_radius_m`.
class MapReader {
 public:
  /// A `node` that is not a mapping is a violation; the reader then behaves as for an empty
  /// mapping.
  MapReader(const Node& node, std::string path, Violations& violations);

  /// The value of a key, or null if it is absent (a violation if `required`).
  const Node* take(std::string_view key, bool required = false);

  /// The scalar values that are not taken yet, by key.
  std::vector<std::pair<std::string, const Node*>> take_scalars();

  /// Reports the keys that were not taken.
  void finish();

  /// Whether the node is a mapping.
  bool is_map() const { return is_map_; }
  /// The path of a key for messages: that of the mapping, a dot, the key.
  std::string path_of(std::string_view key) const;

 private:
  std::map<std::string_view, const Entry*> entries_;
  std::vector<std::string> known_;
  std::string path_;
  Position at_;
  Violations& violations_;
  bool is_map_ = false;
};

/// Typed reading of one value; empty after a violation that names `path`.
std::optional<double> read_number(const Node& node, const std::string& path, const Range& range,
                                  Violations& violations);
std::optional<std::uint32_t> read_count(const Node& node, const std::string& path,
                                        const Range& range, Violations& violations);
std::optional<std::string> read_text(const Node& node, const std::string& path,
                                     Violations& violations);
/// A text of at most `most` printable characters of ASCII, without quotes and backslashes.
std::optional<std::string> read_printable(const Node& node, const std::string& path,
                                          std::size_t most, Violations& violations);
/// One of the known values.
std::optional<std::string> read_choice(const Node& node, const std::string& path,
                                       std::span<const std::string_view> known,
                                       Violations& violations);

/// A list of exactly `size` numbers.
std::optional<std::vector<double>> read_numbers(const Node& node, const std::string& path,
                                                std::size_t size, const Range& range,
                                                Violations& violations);

/// The items of a list of between `min_size` and `max_size` items, or null after a violation.
const std::vector<Node>* read_list(const Node& node, const std::string& path, std::size_t min_size,
                                   std::size_t max_size, Violations& violations);

/// The candidate with the smallest edit distance, if any is similar (for "did you mean").
std::optional<std::string> nearest_key(std::string_view key,
                                       const std::vector<std::string>& candidates);

}  // namespace swarm::yaml
