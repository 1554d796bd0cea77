// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace swarm {

/// Kind of an error; decides the exit code of a program (see exit_code()).
enum class ErrorCode {
  kBadInput,     ///< command line, mission file or other input of the caller is wrong
  kInfeasible,   ///< the input is well-formed, but no plan exists for it
  kEnvironment,  ///< DDS, processes, files, hardware: an operation of the machine failed
};

/// An error that a person can act on.
struct Error {
  ErrorCode code = ErrorCode::kBadInput;  ///< its kind
  /// What is wrong and what to do about it, without a final newline. Several violations are
  /// separated by newlines.
  std::string message;
};

/// A T or an Error, the interface of std::expected: test it as a bool, then read `*result` or
/// `result.error()`. Result<void> carries only success or the error.
template <class T>
using Result = tl::expected<T, Error>;

/// An error to return from a function with a Result of any type:
/// `return fail(ErrorCode::kBadInput, "robots.count is 0; must be > 0");`
inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

/// Exit codes of every program.
enum class ExitCode : int {
  kOk = 0,              ///< success
  kCriteriaNotMet = 1,  ///< no plan exists, or a mission or its audit failed
  kEnvironment = 2,     ///< DDS, processes, files, or an exception that was not expected
  kUsage = 3            ///< command line or input files are wrong
};

/// The exit code of a program that ends with an error of this kind.
constexpr ExitCode exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::kBadInput:
      return ExitCode::kUsage;
    case ErrorCode::kInfeasible:
      return ExitCode::kCriteriaNotMet;
    case ErrorCode::kEnvironment:
      return ExitCode::kEnvironment;
  }
  return ExitCode::kEnvironment;
}

}  // namespace swarm
