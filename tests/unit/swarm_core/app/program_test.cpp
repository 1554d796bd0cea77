// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/program.hpp"

#include <cstdint>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::shell {
namespace {

struct Ended {
  int code;
  std::string printed;  ///< to stderr
};

Ended run(const std::function<Result<ExitCode>()>& body) {
  testing::internal::CaptureStderr();
  const int code = run_main("prog", body);
  return {code, testing::internal::GetCapturedStderr()};
}

TEST(RunMain, EndsWithTheCodeOfItsBodyInSilence) {
  for (const ExitCode code :
       {ExitCode::kOk, ExitCode::kCriteriaNotMet, ExitCode::kEnvironment, ExitCode::kUsage}) {
    const Ended ended = run([&] { return code; });
    EXPECT_EQ(ended.code, static_cast<int>(code));
    EXPECT_EQ(ended.printed, "");
  }
}

TEST(RunMain, EndsWithTheCodeOfTheKindOfAnError) {
  const struct {
    ErrorCode error;
    int code;
  } kinds[] = {
      {ErrorCode::kInfeasible, 1}, {ErrorCode::kEnvironment, 2}, {ErrorCode::kBadInput, 3}};
  for (const auto& kind : kinds) {
    const Ended ended =
        run([&]() -> Result<ExitCode> { return fail(kind.error, "a.yaml:3:7: no"); });
    EXPECT_EQ(ended.code, kind.code);
    EXPECT_EQ(ended.printed, "prog: a.yaml:3:7: no\n");
  }
}

TEST(RunMain, PutsItsNameBeforeEveryLineOfAnError) {
  const Ended ended =
      run([]() -> Result<ExitCode> { return fail(ErrorCode::kBadInput, "one\ntwo\nthree"); });
  EXPECT_EQ(ended.printed, "prog: one\nprog: two\nprog: three\n");
}

// What another host answered, or a mission file holds.
TEST(RunMain, PrintsNoControlCharacters) {
  const Ended ended = run(
      []() -> Result<ExitCode> { return fail(ErrorCode::kBadInput, "no \x1b[2J \u202Egpj.exe"); });
  EXPECT_EQ(ended.printed, "prog: no ?[2J ???gpj.exe\n");
}

TEST(RunMain, ReportsWhatIsThrownAsAProblemOfTheEnvironment) {
  const Ended ended = run([]() -> Result<ExitCode> { throw std::runtime_error("no room"); });
  EXPECT_EQ(ended.code, 2);
  EXPECT_EQ(ended.printed, "prog: unexpected: no room\n");
  EXPECT_EQ(run([]() -> Result<ExitCode> { throw std::bad_alloc(); }).code, 2);
}

/// A program with one required option and the common ones.
class Parse : public testing::Test {
 protected:
  Result<std::optional<ExitCode>> parse_all(std::vector<std::string> arguments) {
    CLI::App app("A program.", "prog");
    app.add_option("--run", run_)->required();
    app.add_option("--count", count_)->check(CLI::Range(1, 100));
    app.add_option("--rate", rate_)->check(CLI::Range(0.0, 100.0));
    app.add_option("--seed", seed_);
    add_common_options(app);
    arguments.insert(arguments.begin(), "prog");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    testing::internal::CaptureStdout();
    auto parsed = parse(app, static_cast<int>(arguments.size()), argv.data());
    printed_ = testing::internal::GetCapturedStdout();
    return parsed;
  }

  std::string run_;
  std::optional<std::uint32_t> count_;
  double rate_ = 0.0;
  std::uint64_t seed_ = 0;
  std::string printed_;
  ScratchFolder folder_;
};

TEST_F(Parse, LeavesTheProgramToDoItsTask) {
  const auto parsed = parse_all({"--run", "runs/1"});
  ASSERT_TRUE(parsed) << parsed.error().message;
  EXPECT_EQ(*parsed, std::nullopt);
  EXPECT_EQ(run_, "runs/1");
}

TEST_F(Parse, PrintsHelpAndVersionWithoutTheRequiredOptions) {
  const auto help = parse_all({"--help"});
  ASSERT_TRUE(help) << help.error().message;
  EXPECT_EQ(*help, ExitCode::kOk);
  EXPECT_NE(printed_.find("--check MISSION.yaml"), std::string::npos) << printed_;

  const auto version = parse_all({"--version"});
  ASSERT_TRUE(version) << version.error().message;
  EXPECT_EQ(*version, ExitCode::kOk);
  EXPECT_EQ(printed_, "prog " SWARM_VERSION "\n");
}

TEST_F(Parse, RefusesWrongUsageAndPointsToTheHelp) {
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{}, {"--run"}, {"--run", "a", "--walk"}, {"--run", "a", "b"}}) {
    const auto parsed = parse_all(wrong);
    ASSERT_FALSE(parsed);
    EXPECT_EQ(parsed.error().code, ErrorCode::kBadInput);
    EXPECT_TRUE(parsed.error().message.ends_with("; see --help")) << parsed.error().message;
  }
}

// CLI11 takes 010 for 8, 0x8 for 8, -1 for 2^64 - 1, and NaN for a number of any range.
TEST_F(Parse, TakesDecimalNumbersAlone) {
  const auto takes = [this](const std::string& option, const std::string& number) {
    return parse_all({"--run", "a", option, number}).has_value();
  };
  for (const char* const wrong : {"010", "0x8", "1e1", "8.0", "-1", "", "8 ", "nan", "101"}) {
    EXPECT_FALSE(takes("--count", wrong)) << wrong;
  }
  for (const char* const wrong : {"nan", "inf", "0x1p3", "1e999", "-nan", "5s"}) {
    EXPECT_FALSE(takes("--rate", wrong)) << wrong;
  }
  for (const char* const wrong : {"-1", "99999999999999999999999", "007"}) {
    EXPECT_FALSE(takes("--seed", wrong)) << wrong;
  }
  EXPECT_TRUE(takes("--count", "10"));
  EXPECT_EQ(count_, 10U);
  EXPECT_TRUE(takes("--rate", "1e1"));
  EXPECT_EQ(rate_, 10.0);
  EXPECT_TRUE(takes("--seed", "18446744073709551615"));
  EXPECT_EQ(seed_, 18446744073709551615U);
  EXPECT_TRUE(takes("--seed", "0"));
}

TEST_F(Parse, ChecksAMissionInBothSpellingsWithoutTheRequiredOptions) {
  const std::string good = SWARM_SOURCE_DIR "/deploy/missions/small.yaml";
  for (const std::vector<std::string>& spelling :
       {std::vector<std::string>{"--check", good}, {"--check=" + good}}) {
    const auto checked = parse_all(spelling);
    ASSERT_TRUE(checked) << checked.error().message;
    EXPECT_EQ(*checked, ExitCode::kOk);
    EXPECT_EQ(printed_, good + ": ok\n");
  }
}

TEST_F(Parse, ReportsTheErrorsOfACheckedMissionWithTheirPlaces) {
  folder_.write("bad.yaml", "version: 1\nwings: 2\n");

  const auto checked = parse_all({"--check", (folder_ / "bad.yaml").string()});

  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::kBadInput);
  for (const char* error : {"bad.yaml:1:1: world is missing; add it\n",
                            "\nbad.yaml:2:1: unknown key wings; known here: "}) {
    EXPECT_NE(checked.error().message.find(error), std::string::npos) << checked.error().message;
  }
  EXPECT_EQ(printed_, "");
}

TEST_F(Parse, RefusesACheckOfNothing) {
  const auto checked = parse_all({"--run", "a", "--check"});
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace swarm::shell
