// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/program.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <sstream>
#include <string_view>
#include <system_error>

#include <CLI/CLI.hpp>

#include "swarm_core/app/foreign_settings.hpp"
#include "swarm_core/app/output.hpp"
#include "swarm_core/base/printable.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::shell {

namespace {

/// Messages quote mission files, arguments and what other hosts answered, with any bytes.
int report(const std::string& name, const Error& error) {
  std::istringstream lines(error.message);
  for (std::string line; std::getline(lines, line);) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), printable(line).c_str());
  }
  return static_cast<int>(exit_code(error.code));
}

/// Whether the whole text is a decimal number of this type. from_chars() does not depend on the
/// locale.
template <class Number>
bool is_decimal(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && std::isfinite(double(value));
}

/// CLI11 converts by strtod() and strtoull(): NaN passes its ranges, 010 is 8, and -1 is 2^64 - 1.
void demand_decimals(CLI::App& app) {
  for (CLI::Option* const option : app.get_options()) {
    const std::string type = option->get_type_name();
    if (type.starts_with("FLOAT")) {
      option->check([](const std::string& text) {
        return is_decimal<double>(text) ? std::string() : "'" + text + "' is no decimal number";
      });
    } else if (type.starts_with("INT") || type.starts_with("UINT")) {
      const bool has_sign = type.starts_with("INT");
      option->check(
          [has_sign](const std::string& text) { return objection_to_whole(text, has_sign); });
    }
  }
  for (CLI::App* const command : app.get_subcommands([](CLI::App*) { return true; })) {
    demand_decimals(*command);
  }
}

}  // namespace

/// A leading zero would make it octal.
std::string objection_to_whole(const std::string& text, bool has_sign) {
  const std::size_t first = text.find_first_not_of("+-");
  const bool is_octal = first != std::string::npos && text[first] == '0' && text.size() > first + 1;
  const bool is_number =
      has_sign ? is_decimal<std::int64_t>(text) : is_decimal<std::uint64_t>(text);
  return is_number && !is_octal ? std::string() : "'" + text + "' is no whole decimal number";
}

// Domain code returns errors as values; what is thrown nevertheless (for example std::bad_alloc)
// ends here with the exit code of a failing environment. A result that could not be printed must
// not look like a success; another failure keeps its own exit code.
int run_main(const std::string& name, const std::function<Result<ExitCode>()>& body) {
  hold_standard_streams();
  drop_foreign_settings();
  try {
    const Result<ExitCode> code = body();
    int status = code ? static_cast<int>(*code) : report(name, code.error());
    if (const auto printed = finish_output(); !printed) {
      const int lost = report(name, printed.error());
      if (status == static_cast<int>(ExitCode::kOk)) status = lost;
    }
    return status;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: unexpected: %s\n", name.c_str(), printable(e.what()).c_str());
    return static_cast<int>(ExitCode::kEnvironment);
  }
}

std::string program_name(const char* argv0, const std::string& own) {
  const std::string name = argv0 == nullptr ? "" : argv0;
  return name == "swarm_launcher" || name.starts_with("swarm_launcher ") ? name : own;
}

void add_common_options(CLI::App& app) {
  app.set_version_flag("--version", app.get_name() + " " + SWARM_VERSION);
  app.add_option("--check", "Validate a mission file, report every error in it, and exit")
      ->type_name("MISSION.yaml");
}

Result<std::optional<ExitCode>> parse(CLI::App& app, int argc, char** argv,
                                      const Catalogue& catalogue) {
  // --check replaces the program's normal task, so it is handled before the parser demands the
  // options that the program otherwise requires.
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    // CLI11 accepts both `--check FILE` and `--check=FILE`; so does this search before its parser
    // runs.
    const bool inline_value = argument.starts_with("--check=");
    if (!inline_value && argument != "--check") continue;
    if (!inline_value && i + 1 == argc) break;
    const std::string file = inline_value ? argument.substr(8) : argv[i + 1];
    const auto mission = load_mission(file, catalogue);
    if (!mission) return tl::unexpected(mission.error());
    std::printf("%s: ok\n", file.c_str());
    return ExitCode::kOk;
  }
  demand_decimals(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    // CLI11 reports --help and --version as exceptions with exit code 0.
    if (e.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
      app.exit(e);  // prints help or version
      return ExitCode::kOk;
    }
    return fail(ErrorCode::kBadInput, std::string(e.what()) + "; see --help");
  }
  return std::nullopt;
}

}  // namespace swarm::shell
