// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/file_watch.hpp"

#include <cstring>
#include <utility>

#include <fmt/format.h>

namespace swarm::shell {
namespace {

std::string describe(const FileHealth& health) {
  std::string text =
      fmt::format("{} cannot be written: {}",
                  health.first.empty() ? "a file" : health.first.filename().string(),
                  health.error == 0 ? "the disk does not answer" : std::strerror(health.error));
  if (health.failing > 1) text += fmt::format("; {} files in all", health.failing);
  return text + "; records wait in memory";
}

}  // namespace

// A loss is reported when writing works again, with its number, rather than for every record.
std::optional<FileWatch::Event> FileWatch::step(const FileHealth& health) {
  const bool fails = health.failing > 0;
  if (fails != fails_) {
    fails_ = fails;
    if (fails) return Event{.is_warning = true, .code = kDiskFails, .text = describe(health)};
    return Event{.code = kDiskWorks, .text = "all files can be written again"};
  }
  if (fails) return std::nullopt;
  const std::uint64_t lost = health.lost - std::exchange(lost_, health.lost);
  const std::uint32_t removed = health.removed - std::exchange(removed_, health.removed);
  if (lost == 0 && removed == 0) return std::nullopt;
  std::string text;
  if (lost > 0) text = fmt::format("{} record{} found no room", lost, lost == 1 ? "" : "s");
  if (removed > 0) {
    text += fmt::format("{}{} file{} removed while in use and made again", lost > 0 ? "; " : "",
                        removed, removed == 1 ? " was" : "s were");
  }
  return Event{.is_warning = true, .code = kRecordsLost, .text = std::move(text)};
}

}  // namespace swarm::shell
