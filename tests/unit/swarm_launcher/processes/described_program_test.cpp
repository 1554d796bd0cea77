// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/described_program.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_launcher/processes/builtin_catalogue.hpp"
#include "tests/unit/swarm_core/app/scratch_folder.hpp"

namespace swarm::launcher {
namespace {

namespace fs = std::filesystem;

using Names = std::vector<std::string>;
Names names_of(const Components& components) {
  Names names;
  for (const ComponentSpec& component : components) names.push_back(component.name);
  return names;
}

/// Programs that are shell scripts.
class DescribedProgram : public testing::Test {
 protected:
  fs::path program(const std::string& name, const std::string& script) const {
    folder_.write(name, "#!/bin/sh\n" + script + "\n");
    fs::permissions(folder_ / name, fs::perms::owner_all);
    return folder_ / name;
  }
  /// A program that prints this catalogue when it is asked to describe itself, and nothing else.
  fs::path printing(const std::string& name, const Catalogue& catalogue) const {
    folder_.write(name + ".json", to_json(catalogue));
    return program(name, "[ \"$*\" = --describe ] && exec cat '" +
                             (folder_ / (name + ".json")).string() + "'");
  }
  std::string error_of(const fs::path& path) const {
    const auto refused = describe_program(path);
    EXPECT_FALSE(refused);
    if (refused) return "";
    EXPECT_EQ(refused.error().code, ErrorCode::kBadInput);
    EXPECT_TRUE(refused.error().message.starts_with(path.string())) << refused.error().message;
    return refused.error().message;
  }

  ScratchFolder folder_;
};

TEST_F(DescribedProgram, IsReadAsItDescribesItself) {
  Catalogue wrote;
  wrote.drivers = {{.name = "quadcopter", .doc = "Flies \"high\".", .options = {}},
                   {.name = "boat", .doc = "Ω", .options = {}}};
  wrote.control_methods = {{.name = "boids", .doc = "Flocks.", .options = {}}};

  const auto read = describe_program(printing("agent", wrote));

  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(to_json(*read), to_json(wrote));
}

TEST_F(DescribedProgram, IsRefusedWhereItCannotBeStarted) {
  EXPECT_EQ(error_of(folder_ / "none"),
            (folder_ / "none").string() + ": cannot be started: No such file or directory");
  EXPECT_NE(error_of(folder_.path()).find("cannot be started"), std::string::npos);
}

TEST_F(DescribedProgram, IsRefusedWhenItFails) {
  for (const char* script : {"exit 1", "echo '{}'; exit 3", "kill -9 $$"}) {
    EXPECT_NE(error_of(program("failing", script))
                  .find(" --describe: ended with an error; is it a program that calls run_robot() "
                        "or run_planner()?"),
              std::string::npos)
        << script;
  }
}

TEST_F(DescribedProgram, IsRefusedWhenItPrintsAnythingElse) {
  for (const char* script : {"true", "echo usage: prog FILE", "echo '[1, 2]'", "echo '{\"a\":'"}) {
    error_of(program("other", script));
  }
}

TEST_F(DescribedProgram, IsRefusedWhenItPrintsWithoutEnd) {
  error_of(program("babbling", "exec yes"));
}

// It is killed: a process of the test's own that stayed would keep waitpid() busy.
TEST_F(DescribedProgram, IsKilledWhenItDoesNotEndWhetherItHoldsItsOutputOrNot) {
  for (const char* script : {"exec sleep 600", "echo '{}'; exec >&-; exec sleep 600"}) {
    const auto refused =
        describe_program(program("hanging", script), std::chrono::milliseconds(100));
    ASSERT_FALSE(refused) << script;
    EXPECT_NE(refused.error().message.find("did not end in time"), std::string::npos);
  }
}

TEST_F(DescribedProgram, ReplacesTheComponentsOfItsKindOnly) {
  Catalogue own;
  own.drivers = {{.name = "boat", .doc = "Swims.", .options = {}}};
  own.control_methods = {{.name = "boids", .doc = "Flocks.", .options = {}}};
  own.planning_methods = {{.name = "oracle", .doc = "Knows.", .options = {}}};
  const fs::path both = printing("both", own);
  const Catalogue& built_in = builtin_catalogue();

  const auto agent = catalogue_of(both, "");
  ASSERT_TRUE(agent) << agent.error().message;
  EXPECT_EQ(names_of(agent->drivers), Names{"boat"});
  EXPECT_EQ(names_of(agent->control_methods), Names{"boids"});
  EXPECT_EQ(names_of(agent->planning_methods), names_of(built_in.planning_methods));

  const auto planner = catalogue_of("", both);
  ASSERT_TRUE(planner) << planner.error().message;
  EXPECT_EQ(names_of(planner->drivers), names_of(built_in.drivers));
  EXPECT_EQ(names_of(planner->control_methods), names_of(built_in.control_methods));
  EXPECT_EQ(names_of(planner->planning_methods), Names{"oracle"});

  EXPECT_FALSE(catalogue_of(folder_ / "none", both));
  EXPECT_FALSE(catalogue_of(both, folder_ / "none"));
}

TEST(BuiltinCatalogue, NamesTheMethodsAndDriversOfThisBuild) {
  const auto has = [](const Components& components, const Names& names) {
    return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
      return find_component(components, name) != nullptr;
    });
  };
  const Catalogue& sut = builtin_catalogue();
  EXPECT_TRUE(has(sut.planning_methods, {"swarmprm", "rover", "crops", "adoc"}));
  EXPECT_TRUE(has(sut.control_methods, {"apf", "crops", "intermittent_diffusion"}));
  EXPECT_TRUE(has(sut.drivers, {"single_integrator", "double_integrator", "unicycle"}));
  EXPECT_FALSE(sut.planning_is_open || sut.robots_are_open);
  EXPECT_EQ(&sut, &builtin_catalogue()) << "created once";
}

}  // namespace
}  // namespace swarm::launcher
