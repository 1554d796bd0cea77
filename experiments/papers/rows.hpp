// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/papers/flown.hpp"
#include "experiments/papers/table.hpp"

namespace swarm::launcher {

/// What seeds have in common.
struct Row {
  std::string name;
  std::string published;  ///< cells of the papers, ready to print
  std::vector<Flown> flown;
  bool must_hold = true;  ///< that all arrive without contact; not of one that shows where it fails

  template <class Of>
  double mean(Of of) const {
    double sum = 0.0;
    for (const Flown& f : flown) sum += of(f);
    return sum / static_cast<double>(flown.size());
  }
  template <class Of>
  double deviation(Of of) const {
    const double m = mean(of);
    return std::sqrt(mean([&](const Flown& f) { return (of(f) - m) * (of(f) - m); }));
  }
  template <class Of>
  double median(Of of) const {
    std::vector<double> sorted;
    for (const Flown& f : flown) sorted.push_back(of(f));
    std::sort(sorted.begin(), sorted.end());
    return 0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]);
  }
  template <class Of>
  double least(Of of) const {
    double low = of(flown.front());
    for (const Flown& f : flown) low = std::min(low, of(f));
    return low;
  }
  bool all_completed() const {
    return std::all_of(flown.begin(), flown.end(),
                       [](const Flown& f) { return f.outcome == Outcome::kCompleted; });
  }
  bool good() const {
    return !must_hold || std::all_of(flown.begin(), flown.end(), [](const Flown& f) {
      return f.outcome == Outcome::kCompleted && f.arrived == f.robots && f.contacts == 0;
    });
  }
};

/// The rows of a table with their pictures, as text, Markdown and JSON.
class Rows {
 public:
  explicit Rows(const TableOptions& options) : options_(options) {}

  bool quick() const { return options_.quick; }
  Result<Mission> load(const std::string& name) const;

  /// Flies a mission with seeds 1 … `seeds` and adds its row; progress goes to stderr.
  Result<void> add(const std::string& name, const std::string& published, const Mission& mission,
                   std::uint32_t seeds, const SimulationOptions& options = {});
  /// Several missions at a time, one flight of each after the other: what else the machine does
  /// meanwhile falls on all of them, so that their times can be compared.
  struct Named {
    std::string name;
    std::string published;
  };
  Result<void> add_in_turns(const std::vector<Named>& named, std::span<const Mission> missions,
                            std::uint32_t seeds, const SimulationOptions& options = {});
  /// The newest rows show where something fails: they need not hold.
  void may_fail(std::size_t count = 1) {
    for (std::size_t i = 0; i < count; ++i) rows_[rows_.size() - 1 - i].must_hold = false;
  }

  const std::vector<Row>& all() const { return rows_; }
  const Row& newest() const { return rows_.back(); }
  std::span<const Row> newest(std::size_t count) const { return std::span(rows_).last(count); }

  void add_line(const std::string& line) { text_ += line + "\n"; }
  /// The table of all rows.
  void add_published_rows(std::string_view head, std::string_view published_head);
  /// A file of its own beside the table.
  void draw(const std::string& name, std::string svg) {
    pictures_.emplace_back(name, std::move(svg));
  }

  /// Prints, and writes if there is a directory to write to.
  Result<ExitCode> finish() const;

 private:
  const TableOptions& options_;
  std::vector<Row> rows_;
  std::vector<std::pair<std::string, std::string>> pictures_;
  std::string text_;
};

}  // namespace swarm::launcher
