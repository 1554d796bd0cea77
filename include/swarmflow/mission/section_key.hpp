// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "swarmflow/mission/launcher_loss.hpp"
#include "swarmflow/mission/options.hpp"

namespace swarm {

/// One scalar key of a section of the mission file. The tables of these are all that the reader,
/// the writer and docs/mission-keys.md know of a key; its default is that of the member.
template <class Section>
struct SectionKey {
  std::string_view key;  ///< name in the mission file, that of the member
  /// The member that it sets. An optional number is written back only where it is set.
  std::variant<double Section::*, std::uint32_t Section::*, std::optional<double> Section::*,
               LauncherLoss Section::*>
      member;
  Range range;           ///< numbers that it accepts; of no meaning for a choice
  std::string_view doc;  ///< one line for docs/mission-keys.md
};

}  // namespace swarm
