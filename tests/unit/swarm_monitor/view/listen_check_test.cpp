// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/listen_check.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

namespace swarm::monitor {
namespace {

/// A socket that listens on a free port of the loopback interface.
class Listener {
 public:
  Listener() : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(fd_, any, size), 0);
    EXPECT_EQ(::listen(fd_, 1), 0);
    EXPECT_EQ(::getsockname(fd_, any, &size), 0);
    port_ = ntohs(address.sin_port);
  }
  ~Listener() { close(); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  std::uint16_t port() const { return port_; }
  void close() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }

 private:
  int fd_;
  std::uint16_t port_ = 0;
};

TEST(ListenCheck, ReportsAPortInUseWithAddressAndReason) {
  const Listener other;

  const auto bound = can_bind("127.0.0.1", other.port());

  ASSERT_FALSE(bound);
  EXPECT_EQ(bound.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(bound.error().message, "cannot listen on 127.0.0.1 port " +
                                       std::to_string(other.port()) + ": Address already in use");
}

TEST(ListenCheck, LeavesThePortFree) {
  Listener other;
  const std::uint16_t port = other.port();
  other.close();

  // Twice: the first check does not hold the port.
  EXPECT_TRUE(can_bind("127.0.0.1", port));
  EXPECT_TRUE(can_bind("127.0.0.1", port));
}

TEST(ListenCheck, TakesAnyFreePort) {
  EXPECT_TRUE(can_bind("127.0.0.1", 0));
  EXPECT_TRUE(can_bind("0.0.0.0", 0));
}

TEST(ListenCheck, RefusesNamesAndWhatIsNoAddress) {
  // Names are not looked up: that could take seconds, and answers could change.
  for (const char* address : {"localhost", "nowhere.example", "127.0.0.1:80", "256.0.0.1", "::g"}) {
    const auto bound = can_bind(address, 0);
    ASSERT_FALSE(bound) << address;
    EXPECT_EQ(bound.error().code, ErrorCode::kBadInput);
    EXPECT_EQ(bound.error().message, std::string(address) + " is no address to listen on");
  }
}

TEST(ListenCheck, ReportsAnAddressOfAnotherMachine) {
  const auto bound = can_bind("192.0.2.1", 0);  // reserved for documentation
  ASSERT_FALSE(bound);
  EXPECT_EQ(bound.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(bound.error().message.find("cannot listen on 192.0.2.1 port 0: "), 0U);
}

}  // namespace
}  // namespace swarm::monitor
