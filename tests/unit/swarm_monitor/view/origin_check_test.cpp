// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/origin_check.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace swarm::monitor {
namespace {

TEST(TrustedHost, IsANameInAnyCaseWithOrWithoutAPort) {
  const std::vector<std::string> names{"RobotLab", "view.lab"};
  for (const char* host : {"robotlab", "ROBOTLAB:8080", "View.Lab:1", "LocalHost", "localhost:"}) {
    EXPECT_TRUE(trusted_host(host, names)) << host;
  }
  for (const char* host : {"robotlab.evil.example", "robotla", "view.lab.", "xview.lab"}) {
    EXPECT_FALSE(trusted_host(host, names)) << host;
  }
  EXPECT_FALSE(trusted_host("robotlab", {}));
}

TEST(TrustedHost, IsAnAddressAndNothingBehindIt) {
  for (const char* host : {"[fe80::1]", "[2001:db8::7]:8080", "192.168.1.9:8080", "0.0.0.0"}) {
    EXPECT_TRUE(trusted_host(host, {})) << host;
  }
  for (const std::string& host :
       {std::string("127.0.0.1\0.evil.example", 23), std::string("[::1\0x]", 8),
        std::string("[::1].evil.example"), std::string("[::1"), std::string("[]"), std::string("["),
        std::string("127.0.0.1:80.evil.example"), std::string("::1"), std::string("127.1"),
        std::string("2130706433"), std::string("[::1]:80x")}) {
    EXPECT_FALSE(trusted_host(host, {})) << testing::PrintToString(host);
  }
}

TEST(SameOrigin, ComparesHostAndPortOfBothSchemes) {
  EXPECT_TRUE(same_origin("https://[::1]:8080", "[::1]:8080"));
  EXPECT_TRUE(same_origin("http://RobotLab:8080", "robotlab:8080"));
  for (const char* origin : {"null", "ftp://robotlab:8080", "http://robotlab:8081",
                             "http://robotlab:8080/", "http://robotlab:8080.evil.example",
                             "http://evil.example/http://robotlab:8080", "robotlab:8080"}) {
    EXPECT_FALSE(same_origin(origin, "robotlab:8080")) << origin;
  }
}

TEST(SameToken, IsEqualityOfAllTextsButTheEmptyOne) {
  // All texts of up to three of these characters, against each other.
  std::vector<std::string> texts{""};
  for (std::size_t k = 0; texts[k].size() < 3; ++k) {
    for (const char c : {'a', 'b', '\0', '\xFF'}) texts.push_back(texts[k] + c);
  }

  for (const std::string& given : texts) {
    for (const std::string& token : texts) {
      EXPECT_EQ(same_token(given, token), given == token && !token.empty())
          << testing::PrintToString(given) << " " << testing::PrintToString(token);
    }
  }
}

}  // namespace
}  // namespace swarm::monitor
