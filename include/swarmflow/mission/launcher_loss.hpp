// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace swarm {

/// What robots do when the launcher's beats stop.
enum class LauncherLoss : std::uint8_t {
  kHold,    ///< hold until the beats are back
  kFinish,  ///< fly the mission to its end
};

/// The names in a mission file, in the order of the values.
inline constexpr std::array<std::string_view, 2> kLauncherLosses = {"hold", "finish"};

/// The name in a mission file.
constexpr std::string_view to_string(LauncherLoss loss) {
  return kLauncherLosses[static_cast<std::size_t>(loss)];
}

/// The value of a name; empty for any other text.
constexpr std::optional<LauncherLoss> launcher_loss_of(std::string_view name) {
  for (std::size_t i = 0; i < kLauncherLosses.size(); ++i) {
    if (kLauncherLosses[i] == name) return static_cast<LauncherLoss>(i);
  }
  return std::nullopt;
}

}  // namespace swarm
