// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/socket_set.hpp"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

namespace swarm::link {
namespace {

/// A pair of connected sockets: what is written to one is read from the other.
struct Pair {
  Pair() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0, fds.data()), 0); }
  ~Pair() {
    for (const int fd : fds) ::close(fd);
  }
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;
  int in() const { return fds[0]; }
  void send() const { EXPECT_EQ(::write(fds[1], "?", 1), 1); }
  void read() const {
    char c = 0;
    EXPECT_EQ(::read(in(), &c, 1), 1);
  }
  std::array<int, 2> fds{};
};

TEST(SocketSet, NamesASocketForAsLongAsItHoldsSomething) {
  SocketSet sut;
  EXPECT_TRUE(sut.waiting().empty());
  const Pair first, second, third;
  for (const Pair* pair : {&first, &second, &third}) sut.add(pair->in());
  EXPECT_TRUE(sut.waiting().empty());

  third.send();
  third.send();
  first.send();
  EXPECT_TRUE(std::ranges::equal(sut.waiting(), std::array{first.in(), third.in()}));
  third.read();
  EXPECT_TRUE(std::ranges::equal(sut.waiting(), std::array{first.in(), third.in()}))
      << "one is left";
  third.read();
  first.read();
  EXPECT_TRUE(sut.waiting().empty());
  EXPECT_EQ(sut.all().size(), 3U);
}

TEST(SocketSet, ForgetsASocketThatWasRemoved) {
  SocketSet sut;
  const Pair stays, goes;
  sut.add(stays.in());
  sut.add(goes.in());
  goes.send();
  stays.send();

  sut.remove(goes.in());

  EXPECT_TRUE(std::ranges::equal(sut.waiting(), std::array{stays.in()}));
  EXPECT_TRUE(std::ranges::equal(sut.all(), std::array{stays.in()}));
}

}  // namespace
}  // namespace swarm::link
