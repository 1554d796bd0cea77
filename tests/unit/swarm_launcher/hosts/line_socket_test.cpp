// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/line_socket.hpp"

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::launcher {
namespace {

/// Two ends of a connection over loopback.
struct Pair {
  LineServer server = *LineServer::listen({"127.0.0.1", 0});
  LineSocket here = *LineSocket::connect({"127.0.0.1", server.port()});
  LineSocket there = *server.accept();

  /// Receives until the condition holds; the limit only prevents an endless loop.
  bool until(const std::function<bool()>& condition) {
    for (int i = 0; i < 10'000; ++i) {
      if (condition()) return true;
      here.flush();
      there.wait(1);
      there.receive();
    }
    return false;
  }
  std::optional<std::string> next_line(std::size_t most = LineSocket::kMaxLine) {
    std::optional<std::string> line;
    until([&] {
      line = there.line(most);
      return line || there.gone();
    });
    return line;
  }
};

TEST(LineSocket, DeliversAnyLinesInTheirOrder) {
  Pair pair;
  Rng rng(7);
  std::vector<std::string> sent = {"", " ", std::string("\0\r\t", 3), std::string(100'000, 'x')};
  for (int i = 0; i < 300; ++i) {
    std::string line(rng() % 200, '\0');
    for (char& c : line) {
      c = static_cast<char>(rng() % 256);
      if (c == '\n') c = ' ';
    }
    sent.push_back(std::move(line));
  }

  for (const std::string& line : sent) pair.here.send(line);

  for (const std::string& line : sent) ASSERT_TRUE(pair.next_line() == line) << line.size();
  EXPECT_EQ(pair.there.line(), std::nullopt);
}

// Random lines and blocks, read back by their known sizes: neither loses a byte to the other.
TEST(LineSocket, SeparatesLinesFromBlocksWhateverTheyContain) {
  Pair pair;
  Rng rng(8);
  for (int round = 0; round < 100; ++round) {
    std::string block(1 + rng() % 5000, '\0');
    for (char& c : block) c = rng() % 8 == 0 ? '\n' : 'b';
    pair.here.send("block " + std::to_string(block.size()));
    pair.here.send_bytes(block);
    pair.here.send("end");

    ASSERT_EQ(pair.next_line(), "block " + std::to_string(block.size()));
    std::string got;
    ASSERT_TRUE(pair.until([&] {
      got += pair.there.bytes(block.size() - got.size());
      return got.size() == block.size();
    }));
    ASSERT_TRUE(got == block);
    ASSERT_EQ(pair.next_line(), "end");
  }
}

TEST(LineSocket, TakesALineOfTheLargestSizeAndNoLongerOne) {
  for (const bool ends : {true, false}) {
    Pair pair;
    pair.here.send(std::string(4096, 'x'));
    EXPECT_TRUE(pair.next_line(4096) == std::string(4096, 'x'));
    EXPECT_FALSE(pair.there.gone());

    if (ends) {
      pair.here.send(std::string(4097, 'x'));
    } else {
      pair.here.send_bytes(std::string(4097, 'x'));
    }
    EXPECT_EQ(pair.next_line(4096), std::nullopt) << "with its end: " << ends;
    EXPECT_TRUE(pair.there.gone()) << "with its end: " << ends;
  }
}

TEST(LineSocket, StopsReadingWhenEnoughIsHeld) {
  Pair pair;
  constexpr std::size_t kHeld = 1000;
  constexpr std::size_t kAtOnce = 65'536;  // of one read
  pair.here.send_bytes(std::string(1'000'000, 'x'));
  std::size_t total = 0;
  for (int i = 0; i < 10'000 && total < 1'000'000; ++i) {
    pair.here.flush();
    pair.there.wait(1);
    pair.there.receive(kHeld);
    pair.there.receive(kHeld);
    const std::string got = pair.there.bytes(1'000'000);
    EXPECT_LT(got.size(), kHeld + kAtOnce);
    total += got.size();
  }
  EXPECT_EQ(total, 1'000'000U);
}

TEST(LineSocket, DeliversWhatWasSentBeforeItsPeerLeft) {
  Pair pair;
  pair.here.send("last");
  pair.here.send_bytes("half a line");
  pair.here.flush();
  pair.here.close();
  EXPECT_TRUE(pair.here.gone());

  ASSERT_TRUE(pair.until([&] { return pair.there.gone(); }));
  EXPECT_EQ(pair.there.line(), "last");
  EXPECT_EQ(pair.there.line(), std::nullopt) << "it never got its end";
}

TEST(LineSocket, StillReceivesAfterItHasFinished) {
  Pair pair;
  pair.here.send("request");
  pair.here.finish();
  ASSERT_TRUE(pair.until([&] { return pair.there.gone(); }));
  EXPECT_EQ(pair.there.line(), "request");

  pair.there.close();
  for (int i = 0; i < 10'000 && !pair.here.gone(); ++i) {
    pair.here.wait(1);
    pair.here.receive();
  }
  EXPECT_TRUE(pair.here.gone());
}

TEST(LineSocket, CountsWhatThePeerDoesNotTake) {
  Pair pair;
  pair.here.send("");
  EXPECT_EQ(pair.here.unsent(), 0U);
  const std::string block(64U << 20U, 'x');  // more than the kernel buffers
  pair.here.send_bytes(block);
  pair.here.flush();
  EXPECT_GT(pair.here.unsent(), 0U);
  EXPECT_LE(pair.here.unsent(), block.size());

  pair.there.close();
  for (int i = 0; i < 10'000 && !pair.here.gone(); ++i) {
    pair.here.wait(1);
    pair.here.flush();
  }
  EXPECT_TRUE(pair.here.gone()) << "and without SIGPIPE";
}

TEST(LineSocket, TakesItsConnectionAndItsBuffersAlongWhenMoved) {
  Pair pair;
  pair.here.send("one");
  pair.here.send("two");
  ASSERT_EQ(pair.next_line(), "one");
  ASSERT_TRUE(pair.until([&] { return pair.there.bytes(1) == "t"; }));

  LineSocket moved = std::move(pair.there);
  pair.there = std::move(moved);

  EXPECT_EQ(pair.next_line(), "wo");
  pair.here.send("three");
  EXPECT_EQ(pair.next_line(), "three");
}

TEST(LineServer, AcceptsEachConnectionOnceAndNeverWaits) {
  auto server = LineServer::listen({"127.0.0.1", 0});
  ASSERT_TRUE(server) << server.error().message;
  EXPECT_NE(server->port(), 0);
  EXPECT_FALSE(server->accept());

  const auto one = LineSocket::connect({"127.0.0.1", server->port()});
  const auto two = LineSocket::connect({"localhost", server->port()});
  ASSERT_TRUE(one && two);

  EXPECT_TRUE(server->accept());
  EXPECT_TRUE(server->accept());
  EXPECT_FALSE(server->accept());
}

TEST(LineServer, NamesTheAddressThatIsTaken) {
  const auto first = LineServer::listen({"127.0.0.1", 0});
  ASSERT_TRUE(first);
  const std::string at = "127.0.0.1:" + std::to_string(first->port());
  const auto second = LineServer::listen({"127.0.0.1", first->port()});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(second.error().message, "cannot listen at " + at + ": Address already in use");
}

TEST(LineSocket, NamesTheAddressWhereNoProgramListens) {
  const auto refused = LineSocket::connect({"127.0.0.1", 1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(refused.error().message, "cannot connect to 127.0.0.1:1: Connection refused");
}

}  // namespace
}  // namespace swarm::launcher
