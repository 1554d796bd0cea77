// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/result.hpp"

/// Standard output, where programs print their results. Printing functions are not checked one by
/// one: stdio remembers a failure, and run_main() asks for it at the end.
namespace swarm::shell {

/// Opens standard input, output and error where the program was started without them. Otherwise the
/// next file that it opens, such as a recording, would get their number and what is printed.
void hold_standard_streams();

/// False once something printed could not be written. Long outputs and repeated ones end then.
bool output_works();

/// Writes what is still buffered. kEnvironment if any output of the program was lost, except to a
/// pipe or socket whose reader has left: it has read what it wanted, as in `… | head -1`.
Result<void> finish_output();

}  // namespace swarm::shell
