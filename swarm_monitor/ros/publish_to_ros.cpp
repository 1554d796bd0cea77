// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/ros/publish_to_ros.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "swarm_core/base/clock.hpp"
#include "swarm_monitor/ros/ros_swarm.hpp"
#include "swarm_monitor/ros/stop_command.hpp"
#include "swarm_ros/ros_domain.hpp"
#include "swarm_ros/ros_names.hpp"

namespace swarm::monitor {
namespace {

constexpr Duration kDiagnosticsPeriod = std::chrono::seconds(1);
constexpr Duration kMapPeriod = std::chrono::milliseconds(500);
// A map takes a tenth of the time at most.
constexpr int kMapShare = 10;

/// Endpoints in the ROS domain.
struct RosTopics {
  std::unique_ptr<link::Participant> participant;  // the last to be destroyed
  link::WriterPtr<ros::PoseArray> poses{};
  link::WriterPtr<ros::MarkerArray> markers{};
  link::WriterPtr<ros::OccupancyGrid> map{};
  link::WriterPtr<ros::DiagnosticArray> diagnostics{};
  // A stop must not be lost, and not every publisher is reliable: a reader for each kind.
  std::vector<link::ReaderPtr<ros::Bool>> stops{};

  template <class M>
  Result<void> advertise(link::WriterPtr<M>& writer, const std::string& topic,
                         const ros::RosQos& qos = ros::kWriterQos) {
    auto made = ros::make_writer<M>(*participant, topic, qos);
    if (!made) return tl::unexpected(made.error());
    writer = *std::move(made);
    return {};
  }
};

Result<RosTopics> join_ros(const std::string& name_space) {
  const auto domain = ros::ros_domain_of_environment();
  if (!domain) return tl::unexpected(domain.error());
  auto participant = ros::join(*domain, "swarmflow_monitor");
  if (!participant) return tl::unexpected(participant.error());
  RosTopics topics{.participant = *std::move(participant)};
  Result<void> made = topics.advertise(topics.poses, name_space + "/poses");
  if (made) made = topics.advertise(topics.markers, name_space + "/markers");
  if (made) made = topics.advertise(topics.map, name_space + "/map", ros::kLatchedQos);
  if (made) made = topics.advertise(topics.diagnostics, "diagnostics");
  if (!made) return tl::unexpected(made.error());
  for (const bool reliable : {false, true}) {
    auto stops = ros::make_reader<ros::Bool>(*topics.participant, name_space + "/emergency_stop",
                                             {.reliable = reliable});
    if (!stops) return tl::unexpected(stops.error());
    topics.stops.push_back(*std::move(stops));
  }
  return topics;
}

/// Whether a moment has come that comes once a period.
class Due {
 public:
  explicit Due(Duration period) : period_(period) {}
  void set_period(Duration period) { period_ = period; }
  bool at(SteadyTime now) {
    if (last_ && now - *last_ < period_) return false;
    last_ = now;
    return true;
  }

 private:
  Duration period_;
  std::optional<SteadyTime> last_;
};

/// Publishes what is due, and obeys stops.
class RosLoop {
 public:
  RosLoop(std::filesystem::path run_dir, const RosOutput& output, RosTopics topics)
      : output_(output),
        topics_(std::move(topics)),
        stop_(std::move(run_dir)),
        poses_due_(from_seconds(1.0 / output.rate_hz)),
        lifetime_(std::max<Duration>(std::chrono::milliseconds(500),
                                     from_seconds(2.5 / output.rate_hz))) {}

  bool is_stopping(SteadyTime now) const { return stop_.is_pending(now); }

  void step(RosSwarm& swarm, SteadyTime now, UtcTime utc) {
    topics_.participant->receive();
    obey_stops(now);
    if (poses_due_.at(now)) {
      topics_.poses->write(swarm.poses(utc));
      topics_.markers->write(swarm.markers(utc, lifetime_));
    }
    if (diagnostics_due_.at(now)) topics_.diagnostics->write(swarm.diagnostics(utc));
    if (!map_due_.at(now)) return;
    const std::uint64_t version = swarm.map_version(utc);
    if (std::exchange(map_version_, version) != version) {
      topics_.map->write(swarm.map(output_.resolution_m, utc));
      const Duration took = std::chrono::steady_clock::now() - now;
      map_due_.set_period(std::max<Duration>(kMapPeriod, kMapShare * took));
    }
  }

 private:
  void obey_stops(SteadyTime now) {
    for (const link::ReaderPtr<ros::Bool>& reader : topics_.stops) {
      std::vector<ros::Bool> messages;
      reader->take(messages);
      if (!std::ranges::any_of(messages, &ros::Bool::data)) continue;
      if (!stop_.is_pending(now)) std::fputs("emergency stop received from ROS\n", stderr);
      stop_.request(now);
    }
    stop_.step(now);
  }

  RosOutput output_;
  RosTopics topics_;
  StopCommand stop_;
  Due poses_due_;
  Duration lifetime_;
  Due diagnostics_due_{kDiagnosticsPeriod};
  Due map_due_{kMapPeriod};
  std::uint64_t map_version_ = 0;
};

}  // namespace

Result<void> publish_to_ros(const std::filesystem::path& run_dir, const RosOutput& output,
                            const std::function<bool()>& go_on) {
  auto topics = join_ros(output.name_space);
  if (!topics) return tl::unexpected(topics.error());
  RosSwarm swarm(output.frame);
  RosLoop loop(run_dir, output, *std::move(topics));
  Result<void> fits;
  const auto observed = observe_run(run_dir, swarm, [&] {
    const double cells = swarm.cells(output.resolution_m);
    if (swarm.robots() >= ros::kMaxStatuses) {
      fits = fail(ErrorCode::kBadInput, fmt::format("{} robots do not fit a message, at most {} do",
                                                    swarm.robots(), ros::kMaxStatuses - 1));
      return false;
    }
    if (cells > static_cast<double>(ros::kMaxGrid)) {
      fits = fail(ErrorCode::kBadInput,
                  fmt::format("--resolution-m {}: the map has {:.0f} cells, at most {} fit a "
                              "message; a larger value makes fewer",
                              output.resolution_m, cells, ros::kMaxGrid));
      return false;
    }
    const SteadyTime now = std::chrono::steady_clock::now();
    loop.step(swarm, now, utc_now());
    return go_on() || loop.is_stopping(now);
  });
  return observed ? fits : observed;
}

}  // namespace swarm::monitor
