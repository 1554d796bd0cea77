// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// That these bytes are those of ROS, tests/ros shows.
#include <gtest/gtest.h>

#include "swarm_link/cdr/codec.hpp"
#include "swarm_ros/ros_names.hpp"
#include "swarm_ros/view_messages.hpp"
#include "tests/support/filled_message.hpp"

namespace swarm::ros {
namespace {

template <class M>
class RosMessages : public ::testing::Test {};
using All =
    ::testing::Types<Bool, Twist, TwistStamped, PoseStamped, PoseArray, Odometry, BatteryState,
                     VelocityWorld, OccupancyGrid, DiagnosticArray, MarkerArray>;
TYPED_TEST_SUITE(RosMessages, All);

TYPED_TEST(RosMessages, AreDecodedAsTheyWereEncoded) {
  const auto sent = testing::filled_message<TypeParam>();
  std::vector<std::byte> bytes;
  ASSERT_TRUE(link::encode(sent, bytes));
  TypeParam received;
  ASSERT_TRUE(link::decode(bytes, received));
  EXPECT_EQ(received, sent);
}

TYPED_TEST(RosMessages, AreRefusedWhereTheyAreCut) {
  std::vector<std::byte> bytes;
  ASSERT_TRUE(link::encode(testing::filled_message<TypeParam>(), bytes));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    TypeParam received;
    ASSERT_FALSE(link::decode(std::span(bytes).first(size), received)) << size;
  }
}

TEST(RosNames, AreThoseOnTheWire) {
  EXPECT_EQ(topic_on_wire("/r0/cmd_vel"), "rt/r0/cmd_vel");
  EXPECT_EQ(topic_on_wire("cmd_vel"), "rt/cmd_vel");
  EXPECT_EQ(type_on_wire("geometry_msgs/msg/Twist"), "geometry_msgs::msg::dds_::Twist_");
}

TEST(RosNames, AMessageTakesTheRoomOfWhatIsInIt) {
  MarkerArray markers;
  markers.markers.resize(2);
  std::vector<std::byte> bytes;
  ASSERT_TRUE(link::encode(markers, bytes));
  EXPECT_LT(bytes.capacity(), 10'000U) << "the bounds of its textures are megabytes";
}

TEST(RosNames, SequencesWithinSequencesAreBounded) {
  MarkerArray markers;
  markers.markers.resize(2);
  std::vector<std::byte> bytes;
  EXPECT_TRUE(link::encode(markers, bytes));
  markers.markers.back().points.resize(kMaxPoints + 1);
  EXPECT_FALSE(link::encode(markers, bytes));
}

}  // namespace
}  // namespace swarm::ros
