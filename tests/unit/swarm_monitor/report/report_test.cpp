// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/report/report.hpp"

#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/unit/swarm_monitor/synthetic_run.hpp"
#include "tests/unit/swarm_monitor/well_formed.hpp"

namespace swarm::monitor {
namespace {

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The page without what is no XML: head, style and script.
std::string body_of(const std::string& html) {
  const std::size_t begin = html.find("<body>") + 6;
  return html.substr(begin, html.find("<script>") - begin);
}

TEST(Report, ShowsAGoodRun) {
  SyntheticRun files(6);
  files.write_good_run();

  const auto audited = write_report(files.dir());

  ASSERT_TRUE(audited.has_value()) << audited.error().message;
  EXPECT_TRUE(audited->audit.ok());
  const std::string html = content_of(files.dir() / "report.html");
  EXPECT_EQ(xml_fault(body_of(html)), "");
  EXPECT_EQ(count_of(html, "criteria met"), 1U);
  EXPECT_EQ(count_of(html, "<td class=\"text\">arrived</td>"), 6U);
  const std::string svg = content_of(files.dir() / "paths.svg");
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_EQ(count_of(svg, "<polyline class=\"track"), 6U);
}

TEST(Report, NeedsNothingFromElsewhere) {
  SyntheticRun files(2);
  files.write_good_run();
  ASSERT_TRUE(write_report(files.dir()).has_value());
  const std::string html = content_of(files.dir() / "report.html");

  EXPECT_EQ(count_of(html, "http"), 1U) << "only the name space of SVG";
  for (const char* word : {" src=", "href=", "@import", "url(h"}) {
    EXPECT_EQ(count_of(html, word), 0U) << word;
  }
}

TEST(Report, NamesWhatWentWrongAndWhere) {
  SyntheticRun files(3);
  files.write(0, {.positions_m = straight({5, 10}, {30, 10}, 100), .graceful = false});
  files.write(1, {.positions_m = straight({30, 10}, {5, 10}, 100), .goal = 1});

  const auto audited = write_report(files.dir());

  ASSERT_TRUE(audited.has_value());
  const std::string html = content_of(files.dir() / "report.html");
  EXPECT_EQ(xml_fault(body_of(html)), "");
  EXPECT_EQ(count_of(html, "criteria not met"), 1U);
  EXPECT_EQ(count_of(html, "<li>2 lost: robot 0, 2</li>"), 1U);
  EXPECT_EQ(count_of(html, "class=\"contact\""), 3U) << "one pair, two robots at the obstacle";
  EXPECT_EQ(count_of(html, "no-robot-log"), 1U);
}

TEST(Report, IsSafeAgainstHostileTexts) {
  SyntheticRun files(2);
  files.write_good_run();
  files.write_file("events.jsonl",
                   "{\"utc_ns\":1800000001000000000,\"source\":\"<script>alert(1)</script>\","
                   "\"severity\":\"\\\"><b>\",\"code\":\"&\",\"text\":\"</td><script>\"}\n");

  ASSERT_TRUE(write_report(files.dir()).has_value());

  const std::string html = content_of(files.dir() / "report.html");
  EXPECT_EQ(xml_fault(body_of(html)), "");
  EXPECT_EQ(count_of(html, "<script>"), 1U) << "ours";
  EXPECT_EQ(count_of(html, "&lt;script&gt;alert(1)"), 1U);
}

TEST(Report, FailsOutsideARunDirectory) {
  EXPECT_FALSE(write_report("/nowhere/at/all").has_value());
}

}  // namespace
}  // namespace swarm::monitor
