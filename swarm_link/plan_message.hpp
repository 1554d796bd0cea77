// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "swarm_link/fields.hpp"
#include "swarm_link/schema_version.hpp"

/// The plan on the wire; see messages.hpp.
namespace swarm::link {

/// Bounds of the sequences of a plan, as in the IDL.
inline constexpr std::size_t kMaxPlanNodes = 4096;
inline constexpr std::size_t kMaxPlanLegs = 8192;
inline constexpr std::size_t kMaxPlanRobots = 20'000;

/// A Gaussian of the flow: its mean and covariance, when it is reached, and the share of the robots
/// that pass through it.
struct PlanNodeMessage {
  double mean_x_m = 0, mean_y_m = 0;  ///< world frame, ENU
  double covariance_xx_m2 = 0, covariance_xy_m2 = 0, covariance_yy_m2 = 0;
  double time_s = 0, mass = 0;  ///< plan time; share of all robots
  bool operator==(const PlanNodeMessage&) const = default;

  using M = PlanNodeMessage;
  static constexpr std::string_view kIdlName = "PlanNode";
  static constexpr FieldList<&M::mean_x_m, &M::mean_y_m, &M::covariance_xx_m2, &M::covariance_xy_m2,
                             &M::covariance_yy_m2, &M::time_s, &M::mass>
      kFields{};
};

/// An edge of the flow between two nodes, by their indices, with the share of the robots on it.
struct PlanLegMessage {
  std::uint32_t from_node = 0, to_node = 0;  ///< the later node is the target
  double mass = 0;
  bool operator==(const PlanLegMessage&) const = default;

  using M = PlanLegMessage;
  static constexpr std::string_view kIdlName = "PlanLeg";
  static constexpr FieldList<&M::from_node, &M::to_node, &M::mass> kFields{};
};

/// Where a robot enters a plan that was made in flight. `source` counts the nodes without an
/// incoming leg; kAnySource: any. `share` / 65536 replaces the random draw at the splits that
/// follow.
struct PlanEntryMessage {
  std::uint16_t source = 0, share = 0;
  bool operator==(const PlanEntryMessage&) const = default;

  using M = PlanEntryMessage;
  static constexpr std::string_view kIdlName = "PlanEntry";
  static constexpr FieldList<&M::source, &M::share> kFields{};
};

/// The flow of Gaussians. Ordered by (epoch, version).
struct PlanMessage {
  std::uint16_t schema_version = kSchemaVersion;
  std::uint32_t version = 0;        ///< from 1 in each epoch
  std::uint64_t epoch = 0;          ///< UTC [ns] at which its planner started
  std::uint64_t scene_version = 0;  ///< scene that it was made for
  std::int64_t t0_utc_ns = 0;       ///< when it was published
  double excess_m = 0;              ///< CVaR beyond its limit; 0: kept
  std::vector<PlanNodeMessage> nodes{};
  std::vector<PlanLegMessage> legs{};
  std::vector<PlanEntryMessage> entries{};  ///< by robot id; empty in the first plan
  bool operator==(const PlanMessage&) const = default;

  using M = PlanMessage;
  static constexpr std::string_view kIdlName = "FlowPlan";
  static constexpr FieldList<&M::schema_version, &M::version, &M::epoch, &M::scene_version,
                             &M::t0_utc_ns, &M::excess_m, up_to(kMaxPlanNodes, &M::nodes),
                             up_to(kMaxPlanLegs, &M::legs), up_to(kMaxPlanRobots, &M::entries)>
      kFields{};
};

}  // namespace swarm::link
