// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_core/app/control_socket.hpp"
#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::shell {
namespace {

using Lines = std::vector<std::string>;

struct Bench {
  ScratchFolder folder;
  std::optional<ControlServer> server{*ControlServer::listen(folder.path())};
};

/// Sends "x" to a server that answers with `text`.
Result<bool> ask(const std::string& text, Lines& lines) {
  Bench bench;
  std::thread launcher([&] {
    std::vector<ControlServer::Request> requests;
    while (requests.empty()) requests = bench.server->poll();
    EXPECT_EQ(requests[0].line, "x");
    bench.server->answer(requests[0].client, text);
  });
  const auto result = send_command(bench.folder.path(), "x",
                                   [&](const std::string& line) { lines.push_back(line); });
  launcher.join();
  return result;
}

TEST(SendCommand, IsDoneIfTheLastLineOfTheAnswerIs) {
  const struct {
    std::string answer;
    bool done;
  } cases[] = {{"done", true},
               {"done: obstacle 6", true},
               {"failed: no such obstacle", false},
               {"done so far\nfailed in the end", false},
               {"failed at first\nthen repeated\ndone", true},
               {"not done", false}};
  for (const auto& c : cases) {
    Lines lines;
    const auto result = ask(c.answer, lines);
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(*result, c.done) << c.answer;
    std::string joined;
    for (const std::string& line : lines) joined += (joined.empty() ? "" : "\n") + line;
    EXPECT_EQ(joined, c.answer);
  }
}

TEST(SendCommand, FailsWithoutAnAnswerAndWithoutALauncher) {
  Bench bench;
  std::thread launcher([&] {
    while (bench.server->poll().empty()) {
    }
    bench.server.reset();  // it ends before it answers
  });
  const auto unanswered = send_command(bench.folder.path(), "x", [](const auto&) { FAIL(); });
  launcher.join();
  ASSERT_FALSE(unanswered);
  EXPECT_EQ(unanswered.error().code, ErrorCode::kEnvironment);
  EXPECT_EQ(unanswered.error().message, "the launcher did not answer");

  const auto nothing = send_command(bench.folder.path(), "x", [](const auto&) { FAIL(); });
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().message, "no mission is running in " + bench.folder.path().string() +
                                         ": No such file or directory");
}

}  // namespace
}  // namespace swarm::shell
