// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/run_vendors.hpp"

#include <initializer_list>

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

using link::Vendor;

RunVendors vendors_of(std::initializer_list<const char*> choices) {
  RunVendors vendors;
  for (const char* choice : choices) EXPECT_TRUE(apply_vendor(choice, vendors)) << choice;
  return vendors;
}

TEST(RunVendors, AreFastDdsByDefault) { EXPECT_FALSE(RunVendors{}.any(Vendor::kCycloneDds)); }

TEST(RunVendors, AreSetForAllRolesWithoutARole) {
  const RunVendors vendors = vendors_of({"cyclonedds"});
  EXPECT_FALSE(vendors.any(Vendor::kFastDds));
}

TEST(RunVendors, AreSetByRole) {
  EXPECT_EQ(vendors_of({"launcher=cyclonedds"}), (RunVendors{.launcher = Vendor::kCycloneDds}));
  EXPECT_EQ(vendors_of({"planner=cyclonedds"}), (RunVendors{.planner = Vendor::kCycloneDds}));
  EXPECT_EQ(vendors_of({"agents=cyclonedds"}), (RunVendors{.agents = Vendor::kCycloneDds}));
}

TEST(RunVendors, TakeTheLastChoiceOfARole) {
  EXPECT_EQ(vendors_of({"cyclonedds", "planner=fastdds", "agents=fastdds"}),
            (RunVendors{.launcher = Vendor::kCycloneDds}));
  EXPECT_FALSE(vendors_of({"planner=fastdds", "cyclonedds"}).any(Vendor::kFastDds));
}

TEST(RunVendors, RefuseUnknownNamesAndChangeNothing) {
  RunVendors vendors;
  for (const char* wrong : {"", "half", "FastDDS", "agents", "agents=", "=cyclonedds",
                            "monitor=cyclonedds", "agents=cyclonedds=", " cyclonedds"}) {
    EXPECT_FALSE(apply_vendor(wrong, vendors)) << wrong;
  }
  EXPECT_EQ(vendors, RunVendors{});
}

}  // namespace
}  // namespace swarm::launcher
