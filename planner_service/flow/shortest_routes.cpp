// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/shortest_routes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swarm::planner {
namespace {

// Longer paths share the last bucket; the search stays correct but repeats more work.
constexpr std::size_t kMostBuckets = 1U << 16U;
constexpr std::size_t kArcsLookedAt = 256;
// Narrow buckets are often empty; in wide ones nodes shorten each other's paths after expansion.
constexpr double kBucketsPerArc = 8.0;

// Queue of nodes in buckets of path length. First in, first out within each bucket, so that
// repeated work is bounded as in the Bellman-Ford algorithm.
class BucketQueue {
 public:
  explicit BucketQueue(double width_m) : per_m_(1.0 / width_m) {}

  std::size_t bucket_of(double length_m) const {
    const double bucket = length_m * per_m_;
    return bucket < static_cast<double>(kMostBuckets) ? static_cast<std::size_t>(bucket)
                                                      : kMostBuckets;
  }

  void push(std::size_t bucket, std::uint32_t node) {
    if (bucket >= lists_.size()) lists_.resize(bucket + 1);
    List& list = lists_[bucket];
    const auto entry = static_cast<std::uint32_t>(entries_.size());
    entries_.push_back({node, kNone});
    (list.first == kNone ? list.first : entries_[list.last].next) = entry;
    list.last = entry;
  }

  // Takes the first node of a bucket; false when it is empty.
  bool pop(std::size_t bucket, std::uint32_t& node) {
    List& list = lists_[bucket];
    if (list.first == kNone) return false;
    node = entries_[list.first].node;
    list.first = entries_[list.first].next;
    return true;
  }

  std::size_t buckets() const { return lists_.size(); }

 private:
  static constexpr std::uint32_t kNone = ~0U;
  struct Entry {
    std::uint32_t node;
    std::uint32_t next;
  };
  struct List {
    std::uint32_t first = kNone;
    std::uint32_t last = kNone;
  };
  double per_m_;
  std::vector<Entry> entries_;
  std::vector<List> lists_;
};

// A fraction of the mean arc length, from a sample of at most a few hundred arcs.
double bucket_width_m(const Roadmap& roadmap) {
  double sum_m = 0.0;
  double count = 0.0;
  const std::size_t stride = 1 + roadmap.arcs.size() / kArcsLookedAt;
  for (std::size_t i = 0; i < roadmap.arcs.size(); i += stride) {
    if (!std::isfinite(roadmap.arcs[i].length_m)) continue;
    sum_m += roadmap.arcs[i].length_m;
    count += 1.0;
  }
  return sum_m > 0.0 ? sum_m / (kBucketsPerArc * count) : 1.0;
}

}  // namespace

// Relaxes the arcs of the nodes in the order of buckets. A node may be expanded again when its
// length falls while its bucket is processed.
ShortestRoutes::ShortestRoutes(const Roadmap& roadmap, std::uint32_t source,
                               std::span<const std::uint32_t> targets)
    : length_m_(roadmap.nodes.size(), std::numeric_limits<double>::infinity()),
      previous_(roadmap.nodes.size(), source) {
  BucketQueue queue(bucket_width_m(roadmap));
  std::vector<double> expanded_m(length_m_);  // path length at the last expansion of each node
  std::size_t targets_left = targets.size();
  length_m_[source] = 0.0;
  queue.push(0, source);
  for (std::size_t bucket = 0; bucket < queue.buckets() && (targets.empty() || targets_left > 0);
       ++bucket) {
    for (std::uint32_t node = 0; queue.pop(bucket, node);) {
      const double length_m = length_m_[node];
      if (length_m >= expanded_m[node]) continue;  // an older, longer entry
      expanded_m[node] = length_m;
      for (const Roadmap::Arc& arc : roadmap.arcs_of(node)) {
        const double through_m = length_m + arc.length_m;
        if (through_m >= length_m_[arc.to]) continue;
        length_m_[arc.to] = through_m;
        previous_[arc.to] = node;
        queue.push(queue.bucket_of(through_m), arc.to);
      }
    }
    // All nodes left are in later buckets, so that lengths up to this one are final.
    while (targets_left > 0 && std::isfinite(length_m_[targets[targets_left - 1]]) &&
           queue.bucket_of(length_m_[targets[targets_left - 1]]) <= bucket) {
      --targets_left;
    }
  }
}

std::vector<std::uint32_t> ShortestRoutes::nodes_to(std::uint32_t target) const {
  std::vector<std::uint32_t> nodes;
  if (!std::isfinite(length_m_[target])) return nodes;
  // The source is its own predecessor.
  std::uint32_t node = target;
  for (; previous_[node] != node; node = previous_[node]) nodes.push_back(node);
  nodes.push_back(node);
  std::reverse(nodes.begin(), nodes.end());
  return nodes;
}

// One search from each node of the smaller side, ended by the nodes of the other.
RouteTable::RouteTable(const Roadmap& roadmap, std::span<const std::uint32_t> starts,
                       std::span<const std::uint32_t> goals)
    : starts_(starts.begin(), starts.end()),
      goals_(goals.begin(), goals.end()),
      from_goals_(goals.size() < starts.size()) {
  const std::vector<std::uint32_t>& sources = from_goals_ ? goals_ : starts_;
  searches_.reserve(sources.size());
  for (const std::uint32_t source : sources) {
    searches_.emplace_back(roadmap, source, from_goals_ ? starts_ : goals_);
  }
}

double RouteTable::length_m(std::size_t start, std::size_t goal) const {
  return from_goals_ ? searches_[goal].length_m(starts_[start])
                     : searches_[start].length_m(goals_[goal]);
}

std::vector<std::uint32_t> RouteTable::nodes(std::size_t start, std::size_t goal) const {
  if (!from_goals_) return searches_[start].nodes_to(goals_[goal]);
  std::vector<std::uint32_t> nodes = searches_[goal].nodes_to(starts_[start]);
  std::reverse(nodes.begin(), nodes.end());
  return nodes;
}

}  // namespace swarm::planner
