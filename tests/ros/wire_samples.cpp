// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Prints a sample of each ROS message that is spoken here, its type and its bytes as hex, for
// wire_test.mjs.
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "swarm_link/cdr/codec.hpp"
#include "swarm_ros/view_messages.hpp"
#include "tests/support/filled_message.hpp"

namespace {

using namespace swarm;

template <class M>
void print() {
  std::vector<std::byte> bytes;
  link::encode(testing::filled_message<M>(), bytes);
  std::printf("%s ", std::string(M::kRosType).c_str());
  for (const std::byte b : bytes) std::printf("%02x", static_cast<unsigned>(b));
  std::printf("\n");
}

}  // namespace

int main() {
  using namespace swarm::ros;
  print<Bool>();
  print<Twist>();
  print<TwistStamped>();
  print<PoseStamped>();
  print<PoseArray>();
  print<Odometry>();
  print<BatteryState>();
  print<OccupancyGrid>();
  print<DiagnosticArray>();
  print<MarkerArray>();
}
