// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace swarm::link::fastdds {

/// Makes gettid() cheap for the vendor's library. Debian builds libfastrtps with assertions, and
/// its discovery readers call gettid() at each step to assert that a lock is held: a third of the
/// CPU of 120 agents. The source file defines a syscall() that takes precedence over the one of
/// libc: it answers gettid from a thread-local variable and forwards every other call. This
/// function does nothing at run time; calling it makes the linker include that file.
void cache_thread_ids();

}  // namespace swarm::link::fastdds
