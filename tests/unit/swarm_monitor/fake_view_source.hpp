// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "swarm_monitor/view/cdr_writer.hpp"
#include "swarm_monitor/view/view_source.hpp"

namespace swarm::monitor {

/// Shows what a test puts in.
class FakeViewSource final : public ViewSource {
 public:
  bool is_live = true;
  std::vector<std::string> scene_texts = {
      R"({"op":"scene","t":0,"obstacles":[{"id":0,"polygon":[[1,1],[2,1],[2,2]]},{"id":1,"circle":[5,6,2]}]})"};
  std::vector<std::string> event_texts = {R"({"t":0.5,"text":"one"})"};
  std::vector<std::string> rows = {"[0,1.2,0,3,null,24.1]"};
  std::vector<RawChannel> channels = {
      {"swarm/plan", "swarm::wire::FlowPlan", "struct FlowPlan {};"}};
  std::uint32_t robots = 3;
  std::vector<std::pair<std::optional<double>, std::optional<RobotId>>> asked{};
  std::function<void(const RawSample&)> sink{};

  void poll(UtcTime) override { ++polls; }
  bool live() const override { return is_live; }
  const std::vector<std::string>& scenes() const override { return scene_texts; }
  const std::vector<std::string>& events() const override { return event_texts; }
  const std::vector<std::string>& series() const override { return rows; }
  void view_frame(std::optional<double> time_s, std::optional<RobotId> focus,
                  std::vector<std::byte>& out) override {
    asked.resize(asked.size() % 64);
    asked.emplace_back(time_s, focus);
    out.clear();
    for (const char c : {'S', 'W', 'F', '1'}) append_raw(out, c);
    append_raw(out, robots);
    append_raw(out, time_s.value_or(static_cast<double>(polls)));
    append_raw(out, std::uint32_t{1});
    append_raw(out, std::uint32_t{1});
    for (std::uint32_t i = 0; i < robots; ++i) {
      for (const float value : {static_cast<float>(i), 2.0F, 0.5F}) append_raw(out, value);
      const std::uint32_t was_received = i == 1 ? 0 : 1;  // robot 1 is not
      append_raw(out, was_received << 16U);
    }
    for (const float value : {10.0F, 20.0F, 4.0F, 0.0F, 1.0F, 0.5F}) append_raw(out, value);
    append_raw(out, std::uint32_t{0xFFFFFFFF});
    append_raw(out, std::uint32_t{0});
  }
  const std::vector<RawChannel>& raw_channels() const override { return channels; }
  void on_raw(std::function<void(const RawSample&)> to) override { sink = std::move(to); }
  std::string metrics() const override { return "swarm_robots 3\n"; }

  void publish(std::uint32_t channel, const std::string& bytes) const {
    if (!sink) return;
    sink({channel, UtcTime(Duration(77)), std::as_bytes(std::span(bytes))});
  }

  std::uint64_t polls = 0;
};

}  // namespace swarm::monitor
