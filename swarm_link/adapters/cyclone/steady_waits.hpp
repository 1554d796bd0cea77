// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace swarm::link::cyclone {

/// Makes the vendor's timed waits independent of the wall clock. Cyclone DDS 0.10 waits for its
/// next event until a time of CLOCK_REALTIME: when the clock is set back by an hour, its event
/// thread sleeps for an hour, and the participant neither announces itself nor repeats what was
/// lost. The source file defines a pthread_cond_timedwait() that takes precedence over the one of
/// libc: calls of Cyclone's library wait for the same span by the steady clock, all others are
/// forwarded. This function does nothing at run time; calling it makes the linker include that
/// file.
void wait_by_steady_clock();

}  // namespace swarm::link::cyclone
