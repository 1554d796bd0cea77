// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Compares every list of fields with the text of the IDL: names, types, order and bounds.
#include "swarm_core/robot_log/idl_text.hpp"

#include <map>
#include <regex>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "swarm_link/topics.hpp"

namespace swarm::link::conformance {
namespace {

/// The name of type `T` in the IDL.
template <class T>
std::string idl_type() {
  if constexpr (std::is_enum_v<T>) return idl_type<std::underlying_type_t<T>>();
  if constexpr (Message<T>) return std::string(T::kIdlName);
  if constexpr (std::is_same_v<T, bool>) return "boolean";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "octet";
  if constexpr (std::is_same_v<T, std::uint16_t>) return "unsigned short";
  if constexpr (std::is_same_v<T, std::int32_t>) return "long";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "unsigned long";
  if constexpr (std::is_same_v<T, std::int64_t>) return "long long";
  if constexpr (std::is_same_v<T, std::uint64_t>) return "unsigned long long";
  if constexpr (std::is_same_v<T, double>) return "double";
  return "?";
}

template <class F>
std::string declaration() {
  using T = typename F::Type;
  if constexpr (kIsSequence<T>) {
    return fmt::format("sequence<{}, {}> {};", idl_type<typename T::value_type>(), F::kBound,
                       F::kName);
  } else if constexpr (kIsText<T>) {
    return fmt::format("string<{}> {};", F::kBound, F::kName);
  } else {
    return fmt::format("{} {};", idl_type<T>(), F::kName);
  }
}

template <class M>
std::string declaration_of() {
  std::string text = fmt::format("struct {} {{ {}", M::kIdlName, keyed<M>() ? "@key " : "");
  for_each_field<M>([&](auto field) { text += declaration<decltype(field)>() + " "; });
  return text + "};";
}

/// The IDL of one struct, with the numbers of the constants and single spaces.
std::string idl_of(std::string_view name) {
  std::string text = mcap::wire_idl({name});
  static const std::regex kConstant(R"(const [a-z ]+ ([A-Z_]+) = (\d+);)");
  std::map<std::string, std::string> constants;
  for (std::sregex_iterator it(text.begin(), text.end(), kConstant), end; it != end; ++it) {
    constants[(*it)[1]] = (*it)[2];
  }
  text = text.substr(text.find("struct "));
  text = text.substr(0, text.find("};") + 2);
  for (const auto& [constant, number] : constants) {
    text = std::regex_replace(text, std::regex("\\b" + constant + "\\b"), number);
  }
  return std::regex_replace(text, std::regex(R"(\s+)"), " ");
}

template <class T>
void expect_as_in_idl() {
  if constexpr (kIsSequence<T>) {
    expect_as_in_idl<typename T::value_type>();
  } else if constexpr (Message<T>) {
    EXPECT_EQ(declaration_of<T>(), idl_of(T::kIdlName));
    for_each_field<T>([](auto field) { expect_as_in_idl<typename decltype(field)::Type>(); });
  }
}

template <class... M>
void expect_all(MessageList<M...>) {
  (expect_as_in_idl<M>(), ...);
}

TEST(FieldLists, AreThoseOfTheIdl) { expect_all(AllMessages()); }

}  // namespace
}  // namespace swarm::link::conformance
