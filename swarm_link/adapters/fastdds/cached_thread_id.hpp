// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace swarm::link::fastdds {

/// Makes gettid() cheap for the vendor's library. Debian builds libfastrtps with assertions, and
/// every step of its discovery readers asks the kernel for the thread's id to assert a lock: a
/// third of the CPU of 120 agents. The source file puts a syscall() before libc's that answers this
/// one question from a thread-local variable and passes everything else on. The call itself does
/// nothing; it makes the linker take the file.
void cache_thread_ids();

}  // namespace swarm::link::fastdds
