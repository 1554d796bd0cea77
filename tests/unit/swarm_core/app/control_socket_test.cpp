// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/control_socket.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "swarm_core/app/run_directory.hpp"
#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::shell {
namespace {

/// A client that sends what the test wants, also half lines.
class RawClient {
 public:
  explicit RawClient(const std::filesystem::path& run_dir)
      : fd_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = (run_dir / kControlSocket).string();
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    connected_ = ::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~RawClient() {
    if (fd_ >= 0) ::close(fd_);
  }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  bool connected() const { return connected_; }
  bool send(const std::string& text) const {
    return ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT) ==
           static_cast<ssize_t>(text.size());
  }
  /// Everything until the server closes the connection.
  std::string read_all() const {
    std::string all;
    char byte = 0;
    while (::read(fd_, &byte, 1) == 1) all += byte;
    return all;
  }
  void close() { ::close(std::exchange(fd_, -1)); }

 private:
  int fd_;
  bool connected_ = false;
};

struct Bench {
  ScratchFolder folder;
  std::optional<ControlServer> server{*ControlServer::listen(folder.path())};

  RawClient connect() const { return RawClient(folder.path()); }
  std::vector<std::string> poll_lines() {
    std::vector<std::string> lines;
    for (const auto& request : server->poll()) lines.push_back(request.line);
    return lines;
  }
};

using Lines = std::vector<std::string>;

TEST(ControlServer, ReturnsALineOnceItIsCompleteAndOnlyOnce) {
  Bench bench;
  const RawClient client = bench.connect();
  ASSERT_TRUE(client.connected());

  EXPECT_EQ(bench.poll_lines(), Lines{}) << "a client that sent nothing yet";
  for (const char* part : {"add_obs", "tacle 'circle_m", ": {}'"}) {
    ASSERT_TRUE(client.send(part));
    EXPECT_EQ(bench.poll_lines(), Lines{}) << part;
  }
  ASSERT_TRUE(client.send("\n"));

  EXPECT_EQ(bench.poll_lines(), Lines{"add_obstacle 'circle_m: {}'"});
  EXPECT_EQ(bench.poll_lines(), Lines{});
}

TEST(ControlServer, TakesOnlyTheFirstLineOfAClient) {
  Bench bench;
  const RawClient client = bench.connect();
  ASSERT_TRUE(client.send("pause\nresume\nsto"));
  EXPECT_EQ(bench.poll_lines(), Lines{"pause"});
  ASSERT_TRUE(client.send("p\n"));
  EXPECT_EQ(bench.poll_lines(), Lines{});
}

TEST(ControlServer, AnswersEachClientOnItsOwnConnectionInAnyOrder) {
  Bench bench;
  const RawClient first = bench.connect();
  const RawClient second = bench.connect();
  const RawClient third = bench.connect();
  ASSERT_TRUE(third.send("three\n"));
  ASSERT_TRUE(first.send("one\n"));
  ASSERT_TRUE(second.send("two\n"));
  auto requests = bench.server->poll();
  ASSERT_EQ(requests.size(), 3U);

  std::reverse(requests.begin(), requests.end());
  for (const auto& request : requests) {
    bench.server->answer(request.client, "got " + request.line + "\ndone");
  }

  EXPECT_EQ(first.read_all(), "got one\ndone\n");
  EXPECT_EQ(second.read_all(), "got two\ndone\n");
  EXPECT_EQ(third.read_all(), "got three\ndone\n");
}

TEST(ControlServer, ServesAStopWhoseSenderHasLeft) {
  Bench bench;
  RawClient hasty = bench.connect();
  ASSERT_TRUE(hasty.send("stop\n"));
  hasty.close();

  const auto requests = bench.server->poll();

  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].line, "stop");
  bench.server->answer(requests[0].client, "done");  // must not raise SIGPIPE
}

TEST(ControlServer, ForgetsAClientThatLeftWithoutARequest) {
  Bench bench;
  RawClient silent = bench.connect();
  RawClient half = bench.connect();
  ASSERT_TRUE(half.send("sto"));
  EXPECT_EQ(bench.poll_lines(), Lines{});
  silent.close();
  half.close();
  EXPECT_EQ(bench.poll_lines(), Lines{});

  bench.server->answer(0, "done");  // neither has a request: nothing happens
  bench.server->answer(1, "done");
  bench.server->answer(99, "done");
  const RawClient next = bench.connect();
  ASSERT_TRUE(next.send("pause\n"));
  EXPECT_EQ(bench.poll_lines(), Lines{"pause"});
}

/// Sends `bytes` characters and what follows them, while the server polls; its answer. Requests are
/// answered some polls later, as the launcher does.
std::string answer_to_long_line(std::size_t bytes, const std::string& end, Lines& lines) {
  Bench bench;
  const RawClient client = bench.connect();
  std::string left = std::string(bytes, 'x') + end;
  std::vector<ControlServer::Request> requests;
  int polls_after = 0;
  for (int i = 0; i < 100'000 && polls_after < 3; ++i) {
    const std::string piece = left.substr(0, 4000);
    if (client.send(piece)) left.erase(0, piece.size());
    polls_after += left.empty() ? 1 : 0;
    for (auto& request : bench.server->poll()) requests.push_back(std::move(request));
  }
  for (const auto& request : requests) {
    lines.push_back(request.line);
    bench.server->answer(request.client, "done");
  }
  bench.server.reset();
  return client.read_all();
}

TEST(ControlServer, RefusesALineThatIsTooLongWhetherItEndsOrNot) {
  constexpr std::size_t kMost = 256 * 1024;  // a polygon of 4096 corners
  Lines requests;
  EXPECT_EQ(answer_to_long_line(kMost, "\n", requests), "done\n");
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].size(), kMost);

  for (const char* end : {"", "\n"}) {
    requests.clear();
    EXPECT_EQ(answer_to_long_line(kMost + 1, end, requests), "failed: the line is too long\n");
    EXPECT_TRUE(requests.empty());
  }
}

TEST(ControlServer, KeepsItsClientsAndTheirNumbersWhenItIsMoved) {
  Bench bench;
  const RawClient before = bench.connect();
  ASSERT_TRUE(before.send("pause\n"));
  const auto first = bench.server->poll();
  ASSERT_EQ(first.size(), 1U);

  ControlServer moved = std::move(*bench.server);
  const RawClient after = bench.connect();
  ASSERT_TRUE(after.send("resume\n"));
  const auto second = moved.poll();
  ASSERT_EQ(second.size(), 1U);
  moved.answer(second[0].client, "done resume");
  moved.answer(first[0].client, "done pause");

  EXPECT_EQ(before.read_all(), "done pause\n");
  EXPECT_EQ(after.read_all(), "done resume\n");
}

TEST(ControlServer, LetsOnlyItsUserConnect) {
  const Bench bench;
  struct stat file {};
  ASSERT_EQ(::stat((bench.folder / "control.sock").c_str(), &file), 0);
  EXPECT_TRUE(S_ISSOCK(file.st_mode));
  EXPECT_EQ(file.st_mode & 077U, 0U) << "neither the group nor others";
}

TEST(ControlServer, RemovesItsSocketAtTheEndAndOneThatAKilledLauncherLeft) {
  Bench bench;
  const auto socket = bench.folder / "control.sock";
  bench.server.reset();
  EXPECT_FALSE(std::filesystem::exists(socket));

  bench.folder.write("control.sock", "left over");
  bench.server.emplace(*ControlServer::listen(bench.folder.path()));
  EXPECT_TRUE(bench.connect().connected());
}

TEST(ControlServer, ListensInADirectoryWhosePathIsLongerThanASocketAddress) {
  const ScratchFolder folder;
  const auto deep = folder / (std::string(120, 'a') + "/" + std::string(120, 'b'));
  std::filesystem::create_directories(deep);
  auto server = ControlServer::listen(deep);
  ASSERT_TRUE(server) << server.error().message;

  std::thread client([&] { EXPECT_TRUE(*send_command(deep, "stop", [](const auto&) {})); });
  std::vector<ControlServer::Request> requests;
  while (requests.empty()) requests = server->poll();
  server->answer(requests[0].client, "done");
  client.join();
}

TEST(ControlServer, CannotListenWhereThereIsNoDirectory) {
  const ScratchFolder folder;
  const auto refused = ControlServer::listen(folder / "none");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(refused.error().message, "cannot listen on " + (folder / "none/control.sock").string() +
                                         ": No such file or directory");
}

}  // namespace
}  // namespace swarm::shell
