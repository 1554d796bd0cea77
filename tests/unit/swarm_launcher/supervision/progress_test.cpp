// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/progress.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

namespace swarm::launcher {
namespace {

constexpr char kEnd = '\x01';  // what the test writes last

/// A terminal as far as the live line uses one: it wraps, returns, and erases to the end of a row.
class Terminal {
 public:
  explicit Terminal(std::size_t width) : width_(width), rows_(1) {}

  void write(const std::string& text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text.compare(i, 3, "\033[K") == 0) {
        rows_.back().resize(column_);
        i += 2;
      } else if (text[i] == '\r') {
        column_ = 0;
      } else if (text[i] == '\n') {
        rows_.emplace_back();
      } else {
        put(text[i]);
      }
    }
  }
  /// The rows with their ends trimmed, joined by "|".
  std::string screen() const {
    std::string all;
    for (const std::string& row : rows_) {
      all += (&row == rows_.data() ? "" : "|") + row.substr(0, row.find_last_not_of(' ') + 1);
    }
    return all;
  }

 private:
  void put(char c) {
    if (column_ == width_) {
      rows_.emplace_back();
      column_ = 0;
    }
    rows_.back().resize(std::max(rows_.back().size(), column_ + 1), ' ');
    rows_.back()[column_++] = c;
  }
  std::size_t width_;
  std::size_t column_ = 0;
  std::vector<std::string> rows_;
};

/// Exchanges stderr for a pseudo-terminal of this width and returns what `act` wrote to it.
std::string written_to_terminal(unsigned short width, const std::function<void()>& act) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
  ::grantpt(terminal);
  ::unlockpt(terminal);
  const int program_end = ::open(::ptsname(terminal), O_RDWR | O_NOCTTY);
  const winsize size{.ws_row = 24, .ws_col = width, .ws_xpixel = 0, .ws_ypixel = 0};
  ::ioctl(program_end, TIOCSWINSZ, &size);
  std::fflush(stderr);
  const int before = ::dup(STDERR_FILENO);
  ::dup2(program_end, STDERR_FILENO);
  act();
  std::fputc(kEnd, stderr);
  std::fflush(stderr);
  ::dup2(before, STDERR_FILENO);
  std::string text;
  for (char c = 0; ::read(terminal, &c, 1) == 1 && c != kEnd;) text += c;
  for (const int fd : {before, program_end, terminal}) ::close(fd);
  return text;
}

std::string screen_of(unsigned short width, const std::function<void(Progress&)>& act) {
  const std::string written = written_to_terminal(width, [&] {
    Progress sut;
    act(sut);
  });
  Terminal terminal(width);
  terminal.write(written);
  return terminal.screen();
}

/// Without NO_COLOR, whatever the environment of the tests has.
class ProgressLine : public testing::Test {
 protected:
  ProgressLine() {
    if (const char* value = std::getenv("NO_COLOR")) before_ = value;
    ::unsetenv("NO_COLOR");
  }
  ~ProgressLine() override {
    ::unsetenv("NO_COLOR");
    if (before_) ::setenv("NO_COLOR", before_->c_str(), 1);
  }
  std::optional<std::string> before_;
};

TEST_F(ProgressLine, ReplacesALongerOneWithoutATrace) {
  EXPECT_EQ(screen_of(80,
                      [](Progress& sut) {
                        sut.show("mission running", "t 99 s  arrived 11/12");
                        sut.show("done", "");
                      }),
            "done|");
}

TEST_F(ProgressLine, StaysInOneRowOfATerminalOfAnyWidth) {
  const std::string full = "mission running  t 100 s  ready 100/100  arrived 100/100  lost 0  x";
  for (const int columns : {1, 2, 3, 10, 16, 17, 18, 40, 66, 67, 68, 69, 80, 300}) {
    const auto width = static_cast<unsigned short>(columns);
    const std::string screen = screen_of(width, [](Progress& sut) {
      for (const char* arrived : {"7", "64", "100"}) {
        sut.show("mission running",
                 std::string("t 100 s  ready 100/100  arrived ") + arrived + "/100  lost 0  x");
      }
    });
    std::string expected = full.substr(0, width - 1U);
    expected.resize(expected.find_last_not_of(' ') + 1);
    EXPECT_EQ(screen, expected + "|") << width << " columns";
  }
}

TEST_F(ProgressLine, CutsBetweenCharactersAndNotWithinThem) {
  const auto shown = [](unsigned short width) {
    std::string written = written_to_terminal(width, [] { Progress().show("Δt", "Ωmega"); });
    return written.substr(0, written.find_first_of("\r\n"));
  };
  EXPECT_EQ(shown(2), "Δ");
  EXPECT_EQ(shown(5), "Δt  ");
  EXPECT_EQ(shown(6), "Δt  Ω");
  EXPECT_EQ(shown(7), "Δt  Ωm");
}

TEST_F(ProgressLine, IsNotCutWhereTheTerminalDoesNotKnowItsWidth) {
  const std::string details(500, 'x');
  const std::string written = written_to_terminal(0, [&] { Progress().show("a", details); });
  EXPECT_NE(written.find("a  " + details), std::string::npos);
}

TEST_F(ProgressLine, StandsBelowTheMessages) {
  EXPECT_EQ(
      screen_of(80,
                [](Progress& sut) {
                  sut.print("view: http://127.0.0.1:8080");
                  sut.show("mission running", "t 1 s");
                  sut.print("agent process 3 ended with code 1");
                  sut.show("mission running", "t 2 s");
                }),
      "view: http://127.0.0.1:8080|agent process 3 ended with code 1|mission running  t 2 s|");
}

TEST_F(ProgressLine, LeavesTheCursorInARowOfItsOwnAtTheEnd) {
  EXPECT_EQ(screen_of(80, [](Progress&) {}), "") << "nothing was shown";
  EXPECT_EQ(screen_of(80, [](Progress& sut) { sut.show("a", "b"); }), "a  b|");
  EXPECT_EQ(screen_of(80,
                      [](Progress& sut) {
                        sut.show("a", "b");
                        sut.print("c");
                      }),
            "c|");
}

void play(Progress& sut) {
  sut.show("starting 3 processes", "t 0 s");
  sut.show("starting 3 processes", "t 1 s");
  sut.print("a message");
  sut.show("starting 3 processes", "t 2 s");
  sut.show("mission running", "t 3 s");
  sut.show("starting 3 processes", "t 4 s");
}
constexpr const char* kChanges =
    "starting 3 processes\na message\nmission running\nstarting 3 processes\n";

TEST_F(ProgressLine, BecomesTheChangesOfTheHeadlineWithoutATerminal) {
  testing::internal::CaptureStderr();
  {
    Progress sut;
    play(sut);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), kChanges);
}

// Ctrl-S: the kernel takes nothing for the terminal until Ctrl-Q.
TEST_F(ProgressLine, DoesNotStopItsCallerWhereTheTerminalIsStopped) {
  const std::string written = written_to_terminal(80, [&] {
    Progress sut;
    sut.show("before", "");
    sut.flush();
    ASSERT_EQ(::tcflow(STDERR_FILENO, TCOOFF), 0);
    for (int i = 0; i < 20; ++i) sut.show("mission running", std::to_string(i));
    sut.print("a message");
    ASSERT_EQ(::tcflow(STDERR_FILENO, TCOON), 0);
  });
  EXPECT_LT(written.find("before"), written.find("mission running  19"));
  EXPECT_LT(written.find("mission running  19"), written.find("a message"));
  EXPECT_NE(written.find("a message"), std::string::npos);
}

TEST_F(ProgressLine, BecomesTheChangesOfTheHeadlineWithNoColor) {
  ::setenv("NO_COLOR", "", 1);
  std::string written = written_to_terminal(80, [] {
    Progress sut;
    play(sut);
  });
  std::erase(written, '\r');  // the terminal's line ends
  EXPECT_EQ(written, kChanges);
}

}  // namespace
}  // namespace swarm::launcher
