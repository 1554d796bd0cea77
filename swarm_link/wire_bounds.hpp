// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "swarm_link/messages.hpp"

/// The bounds of idl/swarm.idl, for every back alike (the vendor backs assert that they agree).
namespace swarm::link {

inline constexpr std::size_t kMaxPlanNodes = 4096;
inline constexpr std::size_t kMaxPlanLegs = 8192;
inline constexpr std::size_t kMaxPlanRobots = 20'000;
inline constexpr std::size_t kMaxSceneObstacles = 256;
inline constexpr std::size_t kMaxSceneRemoved = 256;
inline constexpr std::size_t kMaxSceneVertices = 4096;
inline constexpr std::size_t kMaxSceneGoals = 255;
inline constexpr std::size_t kMaxStatusRobots = 100;
inline constexpr std::size_t kMaxRefusalReasons = 16;
inline constexpr std::size_t kMaxHistogramBins = 464;
inline constexpr std::size_t kMaxEventCode = 64;
inline constexpr std::size_t kMaxEventText = 512;

/// Whether every sequence respects its bound. A writer refuses the message otherwise.
template <class M>
bool fits_wire(const M&) {
  return true;
}
inline bool fits_wire(const PlanMessage& m) {
  return m.nodes.size() <= kMaxPlanNodes && m.legs.size() <= kMaxPlanLegs &&
         m.entries.size() <= kMaxPlanRobots;
}
inline bool fits_wire(const SceneMessage& m) {
  return m.removed.size() <= kMaxSceneRemoved && m.obstacles.size() <= kMaxSceneObstacles &&
         m.vertices.size() <= kMaxSceneVertices && m.goal.size() <= kMaxSceneGoals;
}
inline bool fits_wire(const CellStatesMessage& m) { return m.states.size() <= kMaxCellStates; }
inline bool fits_wire(const StatusMessage& m) {
  return m.robots.size() <= kMaxStatusRobots && m.refused.size() <= kMaxRefusalReasons &&
         m.state_age.size() <= kMaxHistogramBins;
}

/// Strings are cut to their bounds instead: half a sentence is better than no event.
template <class M>
void cut_strings(M&) {}
inline void cut_strings(EventMessage& m) {
  if (m.code.size() > kMaxEventCode) m.code.resize(kMaxEventCode);
  if (m.text.size() > kMaxEventText) m.text.resize(kMaxEventText);
}

}  // namespace swarm::link
