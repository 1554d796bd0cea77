// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "swarm_link/gate/refusal.hpp"

namespace swarm::link {

/// Accepts only keys newer than all accepted before. `Key` orders a topic: (epoch, version) of
/// plans, (epoch, number) of heartbeats, a version, an id, a stamp.
template <class Key>
class NewestKey {
 public:
  NewestKey() = default;                             ///< the first key passes, whatever it is
  explicit NewestKey(Key known) : newest_(known) {}  ///< keys up to `known` do not pass

  /// Stores a key that passes; refuses an equal key as duplicate and a lower one as stale.
  Checked<void> accept(const Key& key) {
    if (newest_ && key == *newest_) return refuse(RefusalReason::kDuplicate);
    if (newest_ && key < *newest_) return refuse(RefusalReason::kStale);
    newest_ = key;
    return {};
  }

 private:
  std::optional<Key> newest_{};  ///< empty: nothing accepted yet
};

}  // namespace swarm::link
