// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace swarm::monitor {

/// Valid messages with a few things wrong, or bytes that never were one; the same for the same
/// seed.
class FrameMutator {
 public:
  FrameMutator(std::uint64_t seed, std::vector<std::string> valid)
      : random_(seed), valid_(std::move(valid)) {}

  std::string next() {
    std::string text = valid_[below(valid_.size())];
    if (chance(0.1)) return garbage(below(300));
    if (chance(0.1)) return text;
    for (std::size_t n = 1 + below(4); n > 0; --n) mutate(text);
    return text;
  }
  std::string garbage(std::size_t size) {
    std::string bytes(size, '\0');
    for (char& byte : bytes) byte = static_cast<char>(below(256));
    return bytes;
  }
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }
  bool chance(double share) { return static_cast<double>(below(1U << 20U)) < share * (1U << 20U); }

 private:
  void mutate(std::string& text) {
    static const std::vector<std::string> kTokens = {
        "{",  "}",    "[",   "]",   ":",      ",",     "\"",         "null", "-1",
        "1e", "1e99", "NaN", "\\u", "1e-400", "\\ud8", "4294967296", "true", "\x80"};
    const std::size_t at = below(text.size() + 1);
    switch (below(6)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.insert(at, kTokens[below(kTokens.size())]);
        break;
      case 2:
        text.erase(at, 1 + below(4));
        break;
      case 3:
        text.resize(at);
        break;
      case 4:
        text += valid_[below(valid_.size())];
        break;
      default:
        text.insert(at, std::string(below(200), chance(0.5) ? '[' : '9'));
        break;
    }
  }

  std::mt19937_64 random_;
  std::vector<std::string> valid_;
};

}  // namespace swarm::monitor
