// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "swarmflow/core/result.hpp"

namespace swarm::test {

/// One lock-step flight whose outcome must not change by accident.
struct DigestCase {
  std::filesystem::path mission_file;
  std::string fault;  ///< as `--fault`; empty: a perfect network
  std::uint64_t seed = 1;
};

/// Flies it and hashes its output, one hash per kind of output, so that a difference shows where it
/// is: `steps`, `estimates`, `notes` and `link` of all robot logs, the `plans`, the `clock` of the
/// plan and the `scenes`. Readable texts, process ids and wall times are excluded. The result does
/// not depend on the number of threads. Fails as `simulate` would.
Result<std::string> simulated_digest(const DigestCase& flight);

}  // namespace swarm::test
