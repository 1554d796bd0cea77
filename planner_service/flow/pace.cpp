// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/pace.hpp"

#include <algorithm>

#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

constexpr double kNotReached = -1.0;
constexpr std::uint32_t kNone = UINT32_MAX;

// A path between two nodes that have times, through nodes that have none.
struct Path {
  double tightness = -1.0;  // its least time over the time it has
  double least_s = 0.0;
  std::vector<std::uint32_t> nodes;
};

class Pacer {
 public:
  Pacer(std::span<const double> earliest_s, std::span<const PacedLeg> legs)
      : legs_(legs.begin(), legs.end()),
        times_s_(earliest_s.begin(), earliest_s.end()),
        has_time_(earliest_s.size(), 1),
        longest_s_(earliest_s.size()),
        by_(earliest_s.size()) {
    // By the earliest time of their first node, which is a topological order: legs take positive
    // time.
    std::stable_sort(legs_.begin(), legs_.end(), [&](const PacedLeg& a, const PacedLeg& b) {
      return earliest_s[a.from] < earliest_s[b.from];
    });
    std::vector<char> is_left(earliest_s.size(), 0);
    std::vector<char> is_reached(earliest_s.size(), 0);
    for (const PacedLeg& leg : legs_) {
      is_left[leg.from] = 1;
      is_reached[leg.to] = 1;
    }
    for (std::size_t v = 0; v < has_time_.size(); ++v) {
      if (is_left[v] != 0 && is_reached[v] != 0) has_time_[v] = 0;
    }
  }

  std::vector<double> run() {
    // Every round gives a time to a node.
    while (std::find(has_time_.begin(), has_time_.end(), 0) != has_time_.end()) {
      const Path path = tightest_path();
      SWARM_ASSERT(path.nodes.size() > 2);
      pace(path);
    }
    return times_s_;
  }

 private:
  // The path with the largest ratio of least time to available time, over all pairs of nodes that
  // have times. Longest paths by dynamic programming over the legs in topological order: O(nodes ·
  // legs).
  Path tightest_path() {
    Path tightest;
    for (std::uint32_t from = 0; from < has_time_.size(); ++from) {
      if (has_time_[from] == 0) continue;
      std::fill(longest_s_.begin(), longest_s_.end(), kNotReached);
      longest_s_[from] = 0.0;
      for (std::uint32_t l = 0; l < legs_.size(); ++l) {
        const PacedLeg& leg = legs_[l];
        // A leg between two nodes that have times leaves nothing to pace.
        const bool goes_on = leg.from == from ? has_time_[leg.to] == 0 : has_time_[leg.from] == 0;
        if (!goes_on || longest_s_[leg.from] == kNotReached) continue;
        const double through_s = longest_s_[leg.from] + leg.least_s;
        if (through_s <= longest_s_[leg.to]) continue;
        longest_s_[leg.to] = through_s;
        by_[leg.to] = l;
      }
      for (std::uint32_t to = 0; to < has_time_.size(); ++to) {
        if (has_time_[to] == 0 || to == from || longest_s_[to] == kNotReached) continue;
        const double tightness = longest_s_[to] / (times_s_[to] - times_s_[from]);
        if (tightness <= tightest.tightness) continue;
        tightest = {tightness, longest_s_[to], {to}};
        while (tightest.nodes.back() != from) {
          tightest.nodes.push_back(legs_[by_[tightest.nodes.back()]].from);
        }
      }
    }
    std::reverse(tightest.nodes.begin(), tightest.nodes.end());
    return tightest;
  }

  // Gives the nodes of a path times in proportion to the least times of its legs.
  void pace(const Path& path) {
    const double from_s = times_s_[path.nodes.front()];
    const double stretch = (times_s_[path.nodes.back()] - from_s) / path.least_s;
    double along_s = 0.0;
    for (std::size_t i = 1; i + 1 < path.nodes.size(); ++i) {
      along_s += least_between(path.nodes[i - 1], path.nodes[i]);
      times_s_[path.nodes[i]] = from_s + stretch * along_s;
    }
    for (std::size_t i = 1; i + 1 < path.nodes.size(); ++i) has_time_[path.nodes[i]] = 1;
  }

  // Least time of the leg between two nodes; legs are unique by their ends.
  double least_between(std::uint32_t from, std::uint32_t to) const {
    for (const PacedLeg& leg : legs_) {
      if (leg.from == from && leg.to == to) return leg.least_s;
    }
    return 0.0;
  }

  std::vector<PacedLeg> legs_;
  std::vector<double> times_s_;
  std::vector<char> has_time_;
  std::vector<double> longest_s_;  // scratch of tightest_path()
  std::vector<std::uint32_t> by_;  // last leg on the longest path to a node
};

}  // namespace

// Topological order by Kahn's algorithm: a node is done when all its legs in are. Nodes that remain
// are on or behind a cycle. O(nodes + legs).
std::optional<std::vector<double>> earliest_times_s(std::size_t nodes,
                                                    std::span<const PacedLeg> legs) {
  std::vector<std::uint32_t> legs_in(nodes, 0);
  std::vector<std::uint32_t> first(nodes, kNone);  // leg out of each node, a list by next
  std::vector<std::uint32_t> next(legs.size(), kNone);
  for (std::uint32_t l = 0; l < legs.size(); ++l) {
    ++legs_in[legs[l].to];
    next[l] = first[legs[l].from];
    first[legs[l].from] = l;
  }
  std::vector<double> times_s(nodes, 0.0);
  std::vector<std::uint32_t> open;
  for (std::uint32_t v = 0; v < nodes; ++v) {
    if (legs_in[v] == 0) open.push_back(v);
  }
  std::size_t done = 0;
  for (; !open.empty(); ++done) {
    const std::uint32_t v = open.back();
    open.pop_back();
    for (std::uint32_t l = first[v]; l != kNone; l = next[l]) {
      double& time_s = times_s[legs[l].to];
      time_s = std::max(time_s, times_s[v] + legs[l].least_s);
      if (--legs_in[legs[l].to] == 0) open.push_back(legs[l].to);
    }
  }
  if (done < nodes) return std::nullopt;
  return times_s;
}

std::vector<double> paced_times_s(std::span<const double> earliest_s,
                                  std::span<const PacedLeg> legs) {
  return Pacer(earliest_s, legs).run();
}

}  // namespace swarm::planner
