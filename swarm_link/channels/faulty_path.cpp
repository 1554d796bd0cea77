// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/faulty_path.hpp"

#include <algorithm>

namespace swarm::link {

// Draws the fate of a datagram: lost, or delivered after a delay, or twice. Outside the fault
// window no number is consumed, so the sequence of fates does not depend on the traffic before it.
// The queue is sorted by due time; equal times keep the order of arrival.
void FaultyPath::receive(int fd, std::span<const std::byte> bytes, const sockaddr_in& sender,
                         UtcTime at) {
  if (!reception_.faults.at(at - reception_.run_began)) return keep(at, fd, bytes, sender);
  const std::uint64_t number = received_++;
  const auto delay = fate(reception_.faults, reception_.seed, number);
  if (!delay) return;
  keep(at + *delay, fd, bytes, sender);
  if (const auto copy = fate_of_copy(reception_.faults, reception_.seed, number)) {
    keep(at + *copy, fd, bytes, sender);
  }
}

void FaultyPath::keep(UtcTime due, int fd, std::span<const std::byte> bytes,
                      const sockaddr_in& sender) {
  if (late_.size() >= kMostKept) return;
  const auto place =
      std::upper_bound(late_.begin(), late_.end(), due,
                       [](UtcTime time, const Late& late) { return time < late.due; });
  late_.insert(place, {due, fd, sender, {bytes.begin(), bytes.end()}});
}

// Delivers what is due for this socket and deletes it, together with overdue datagrams of sockets
// that were closed. Datagrams of other sockets stay until those are drained.
void FaultyPath::hand_due(int fd, UtcTime now, DatagramSink& sink) {
  const auto end = std::upper_bound(late_.begin(), late_.end(), now,
                                    [](UtcTime time, const Late& late) { return time < late.due; });
  for (auto late = late_.begin(); late != end; ++late) {
    if (late->fd == fd) sink.datagram(late->bytes, late->sender);
  }
  const auto done = [&](const Late& l) { return l.fd == fd || now - l.due > kAbandoned; };
  late_.erase(std::remove_if(late_.begin(), end, done), end);
}

}  // namespace swarm::link
