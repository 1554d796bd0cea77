// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace swarm {

/// What kind of thing went wrong; decides the exit code of a program (see exit_code()).
enum class ErrorCode {
  kBadInput,     ///< usage, mission file or other input of the caller is wrong
  kInfeasible,   ///< the input is well-formed, but no plan exists for it
  kEnvironment,  ///< DDS, processes, files: the machine said no
};

/// An error a person can act on: `message` says what is wrong and what to do about it. Several
/// violations are separated by newlines.
struct Error {
  ErrorCode code = ErrorCode::kBadInput;
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

/// Exit codes of every program.
enum class ExitCode : int { kOk = 0, kCriteriaNotMet = 1, kEnvironment = 2, kUsage = 3 };

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
