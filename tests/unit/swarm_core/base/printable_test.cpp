// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/base/printable.hpp"

#include <string>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

TEST(Printable, IsTextOfAnyLanguage) {
  for (const char* text : {"", "robot 7", "~", "\u00B5m", "\u20AC", "\u65E5\u672C", "\U0001F916",
                           "\u00A0", "\uFFFD"}) {
    EXPECT_TRUE(is_printable(text)) << text;
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, AreNoControlsAndDirections) {
  for (const char* text : {"\n", "\t", "\x1b[2J", "\x7F", "\u0080", "\u009B", "\u061C", "\u200E",
                           "\u200F", "\u2028", "\u202E", "\u2066", "\u2069"}) {
    EXPECT_FALSE(is_printable(text));
    EXPECT_FALSE(is_printable(std::string("a") + text + "b"));
  }
  EXPECT_EQ(printable("a\x1b[2Jb\u202Ec"), "a?[2Jb???c");
}

// A terminal of one byte per character obeys 0x9B.
TEST(Printable, IsNoMalformedUtf8) {
  for (const char* text :
       {"\x9B", "\xC2", "\xC0\x9B", "\xC1\xBF", "\xE0\x82\x9B", "\xE2\x82", "\xED\xA0\x80",
        "\xF0\x80\x80\x9B", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF"}) {
    EXPECT_FALSE(is_printable(text));
  }
  EXPECT_EQ(printable("a\xC2"), "a?");
}

TEST(Printable, IsWhatIsLeftOfAnyBytes) {
  Rng rng(3);
  for (int i = 0; i < 20'000; ++i) {
    std::string text(rng() % 8, ' ');
    for (char& byte : text) byte = static_cast<char>(rng());
    ASSERT_TRUE(is_printable(printable(text)));
    ASSERT_LE(printable(text).size(), text.size());
  }
}

}  // namespace
}  // namespace swarm
