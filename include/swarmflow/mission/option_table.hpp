// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "swarmflow/mission/options.hpp"

namespace swarm {

/// Binds the keys of a component's options to the members of its own struct, each stated once with
/// its range and one line of documentation. The struct's initialisers are the defaults; they are
/// not checked against the ranges:
///
///   struct SpiralOptions { double gain_hz = 0.5; std::uint32_t turns = 3; };
///   const auto kTable = OptionTable<SpiralOptions>()
///       .number("gain_hz", &SpiralOptions::gain_hz, positive(10), "speed per metre off the path")
///       .count("turns", &SpiralOptions::turns, between(1, 100), "turns before it gives up");
///   kTable.specs()        for the ComponentSpec of a registry
///   kTable.read(values)   the struct with a mission's values
///
/// \tparam T a struct that can be default-constructed and copied
template <class T>
class OptionTable {
 public:
  /// Adds an option of kind kNumber: its key, member, accepted numbers and documentation.
  OptionTable& number(std::string key, double T::*member, Range range, std::string doc) {
    add(std::move(key), OptionSpec::Kind::kNumber, range, std::move(doc));
    specs_.back().fallback = written(T{}.*member);
    readers_.push_back([member](T& out, const OptionValues& values, const std::string& k) {
      if (const auto value = values.number(k)) out.*member = *value;
    });
    return *this;
  }

  /// Adds an option of kind kCount: its key, member, accepted numbers and documentation.
  OptionTable& count(std::string key, std::uint32_t T::*member, Range range, std::string doc) {
    add(std::move(key), OptionSpec::Kind::kCount, range, std::move(doc));
    specs_.back().fallback = std::to_string(T{}.*member);
    readers_.push_back([member](T& out, const OptionValues& values, const std::string& k) {
      if (const auto value = values.number(k)) out.*member = static_cast<std::uint32_t>(*value);
    });
    return *this;
  }

  /// Adds an option of kind kChoice: its key, member, accepted choices and documentation.
  OptionTable& choice(std::string key, std::string T::*member, std::vector<std::string> choices,
                      std::string doc) {
    add(std::move(key), OptionSpec::Kind::kChoice, {}, std::move(doc));
    specs_.back().fallback = T{}.*member;
    specs_.back().choices = std::move(choices);
    readers_.push_back([member](T& out, const OptionValues& values, const std::string& k) {
      if (const std::string* value = values.find(k)) out.*member = *value;
    });
    return *this;
  }

  /// Adds an option of kind kText: its key, member and documentation.
  OptionTable& text(std::string key, std::string T::*member, std::string doc) {
    add(std::move(key), OptionSpec::Kind::kText, {}, std::move(doc));
    specs_.back().fallback = T{}.*member;
    readers_.push_back([member](T& out, const OptionValues& values, const std::string& k) {
      if (const std::string* value = values.find(k)) out.*member = *value;
    });
    return *this;
  }

  /// Adds the options of a struct that T is derived from: components that read the same keys share
  /// their table.
  template <class Base>
  requires std::derived_from<T, Base> OptionTable& with(const OptionTable<Base>& shared) {
    for (std::size_t i = 0; i < shared.specs().size(); ++i) {
      specs_.push_back(shared.specs()[i]);
      readers_.push_back(shared.readers()[i]);
    }
    return *this;
  }

  /// Adds a rule: the number of the option added last must not exceed that of this key.
  OptionTable& at_most(std::string key) {
    specs_.back().at_most = std::move(key);
    return *this;
  }

  /// The specs of all options, in the order of their calls.
  const std::vector<OptionSpec>& specs() const { return specs_; }
  /// What reads each of them into the struct; for with().
  const auto& readers() const { return readers_; }

  /// The struct with the values that are set, defaults for the others. Values are expected to be
  /// checked: a number that cannot be read counts as not set. Cost: a lookup per option.
  T read(const OptionValues& values) const {
    T out;
    for (std::size_t i = 0; i < specs_.size(); ++i) readers_[i](out, values, specs_[i].key);
    return out;
  }

 private:
  static std::string written(double value) {
    OptionValues values;
    values.set("x", value);
    return *values.find("x");
  }

  void add(std::string key, OptionSpec::Kind kind, const Range& range, std::string doc) {
    specs_.push_back({.key = std::move(key),
                      .kind = kind,
                      .fallback = {},
                      .range = range,
                      .doc = std::move(doc)});
  }

  std::vector<OptionSpec> specs_;
  std::vector<std::function<void(T&, const OptionValues&, const std::string&)>> readers_;
};

}  // namespace swarm
