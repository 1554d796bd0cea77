// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/papers/flown.hpp"
#include "experiments/papers/table.hpp"

namespace swarm::launcher {

/// A row of the table: the flights of one mission with different seeds.
struct Row {
  std::string name;
  std::string published;  ///< cells of the papers, ready to print
  std::vector<Flown> flown;
  bool must_hold = true;  ///< whether all have to arrive without contact for the table to succeed

  /// Mean of a quantity over the seeds.
  template <class Of>
  double mean(Of of) const {
    double sum = 0.0;
    for (const Flown& f : flown) sum += of(f);
    return sum / static_cast<double>(flown.size());
  }
  /// Standard deviation over the seeds, of the population (divided by n).
  template <class Of>
  double deviation(Of of) const {
    const double m = mean(of);
    return std::sqrt(mean([&](const Flown& f) { return (of(f) - m) * (of(f) - m); }));
  }
  /// Median over the seeds, the mean of the two in the middle for an even number.
  template <class Of>
  double median(Of of) const {
    std::vector<double> sorted;
    for (const Flown& f : flown) sorted.push_back(of(f));
    std::sort(sorted.begin(), sorted.end());
    return 0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]);
  }
  /// Smallest value over the seeds: gaps are reported by their worst case.
  template <class Of>
  double least(Of of) const {
    double low = of(flown.front());
    for (const Flown& f : flown) low = std::min(low, of(f));
    return low;
  }
  /// Whether no flight ended at its time limit or was interrupted.
  bool all_completed() const {
    return std::all_of(flown.begin(), flown.end(),
                       [](const Flown& f) { return f.outcome == Outcome::kCompleted; });
  }
  /// Whether the row meets what its table requires.
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

  /// Whether the table is made with fewer robots and seeds.
  bool quick() const { return options_.quick; }
  /// A mission file of the missions folder, by its name without extension.
  Result<Mission> load(const std::string& name) const;

  /// Flies a mission with seeds 1 … `seeds` and adds its row; progress goes to stderr.
  Result<void> add(const std::string& name, const std::string& published, const Mission& mission,
                   std::uint32_t seeds, const SimulationOptions& options = {});
  /// Several missions at a time, one flight of each after the other: other load on the machine
  /// affects all of them alike, so that their times can be compared.
  struct Named {
    std::string name;
    std::string published;
  };
  Result<void> add_in_turns(const std::vector<Named>& named, std::span<const Mission> missions,
                            std::uint32_t seeds, const SimulationOptions& options = {});
  /// Marks the newest rows as experiments that may fail, such as ablations.
  void may_fail(std::size_t count = 1) {
    for (std::size_t i = 0; i < count; ++i) rows_[rows_.size() - 1 - i].must_hold = false;
  }

  /// Rows in the order in which they were added.
  const std::vector<Row>& all() const { return rows_; }
  const Row& newest() const { return rows_.back(); }
  std::span<const Row> newest(std::size_t count) const { return std::span(rows_).last(count); }

  /// A line of Markdown of its own, such as a note.
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
