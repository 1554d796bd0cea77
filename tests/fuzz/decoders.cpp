// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/decoders.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <unistd.h>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/mission/link_faults.hpp"
#include "swarm_core/mission_file/scene_change_file.hpp"
#include "swarm_core/plan/plan_json.hpp"
#include "swarm_core/robot_log/reader.hpp"
#include "swarm_core/robot_log/record_codec.hpp"
#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarm_launcher/hosts/last_position.hpp"
#include "swarm_launcher/hosts/line_socket.hpp"
#include "swarm_launcher/hosts/offer.hpp"
#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/channels/groups/rtps_datagram.hpp"
#include "swarm_link/gate/gate.hpp"
#include "swarm_monitor/view/foxglove_session.hpp"
#include "swarm_monitor/view/page_session.hpp"
#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "tests/conformance/samples.hpp"

namespace swarm::fuzz {
namespace {

using Input = std::span<const std::uint8_t>;

std::string_view text_of(Input bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }
std::span<const std::byte> raw(Input bytes) { return std::as_bytes(bytes); }

void require(bool condition) {
  if (!condition) std::abort();
}

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A file in memory: some readers take a path.
class MemoryFile {
 public:
  explicit MemoryFile(Input bytes) : fd_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    require(fd_ >= 0 &&
            ::write(fd_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  }
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

// Mission files.

constexpr const char* kYard = R"(version: 1
name: yard
world:
  bounds_m: [0, 0, 40, 30]
  obstacles: [{polygon_m: [[17, 7], [24, 6], [25, 9], [18, 10.5]]}, {circle_m: {center: [9, 9], radius: 1}}]
robots: {count: 4, radius_m: 0.2}
start: [{mean_m: [6, 21], covariance_m2: [[4, 0], [0, 4]], weight: 1}]
goal: [{mean_m: [33, 22], covariance_m2: [[4, 0], [0, 4]], weight: 1}]
script: [{at_s: 5, action: pause}, {at_s: 6, action: resume}]
)";

// What is accepted can be written and is read again.
void mission(Input bytes) {
  const auto read = parse_mission(text_of(bytes), "fuzzed", "/nonexistent");
  if (read) require(parse_mission(to_yaml(*read), "written", "/nonexistent").has_value());
}
std::vector<Bytes> missions() {
  std::vector<Bytes> out = {bytes_of(kYard)};
  for (const auto& entry :
       std::filesystem::directory_iterator(SWARM_SOURCE_DIR "/deploy/missions")) {
    // These fit Gaussians to a polygon, which takes seconds with sanitizers.
    const bool fits = entry.path().stem().string().starts_with("diffusion_");
    if (entry.path().extension() == ".yaml" && !fits) {
      out.push_back(bytes_of(content(entry.path())));
    }
  }
  return out;
}

// Changes of the scene, as `command` and scripts give them: "action keys".

const World& yard() {
  static const Mission mission = parse_mission(kYard, "yard").value();  // throws if it is wrong
  return mission.world;
}
void scene_change(Input bytes) {
  const std::string text(text_of(bytes));
  const std::size_t space = std::min(text.find(' '), text.size());
  const auto change = parse_scene_change(text.substr(0, space), text.substr(space), yard());
  if (change) {
    require(
        parse_scene_change(std::string(name_of(*change)), keys_of(*change), yard()).has_value());
  }
}
std::vector<Bytes> scene_changes() {
  return {bytes_of("add_obstacle circle_m: {center: [20, 20], radius: 1.5}"),
          bytes_of("add_obstacle polygon_m: [[1, 1], [3, 1], [2, 4]]"),
          bytes_of("move_obstacle obstacle: 3, by_m: [2, 0], over_s: 4"),
          bytes_of("remove_obstacle obstacle: 0"),
          bytes_of("goto goal: [{mean_m: [30, 15], covariance_m2: [[4, 0], [0, 4]], weight: 1}]"),
          bytes_of("risk alpha: 0.2"),
          bytes_of("add_body robot: 2, circle_m: {center: [9, 9], radius: 1}"),
          bytes_of("clear 7")};
}

// Small texts of command lines, files and other hosts.

void small_texts(Input bytes) {
  const std::string text(text_of(bytes));
  (void)parse_link_faults(text);
  (void)launcher::parse_host_port(text);
  (void)catalogue_from_json(text, "fuzzed");
}
std::vector<Bytes> small_text_seeds() {
  return {bytes_of("loss=0.2,delay-ms=150,jitter-ms=50,from=10,to=60"), bytes_of("10.0.0.1:7000"),
          bytes_of(to_json(open_catalogue()))};
}

void offer(Input bytes) {
  const auto read = launcher::parse_offer(std::string(text_of(bytes)));
  if (read) require(launcher::parse_offer(launcher::to_line(*read)).has_value());
}

void last_position(Input bytes) {
  const auto json = nlohmann::json::parse(text_of(bytes), nullptr, false);
  const auto read = launcher::parse_last_position(json);
  if (!read) return;
  const auto line = nlohmann::json::parse(launcher::to_line(*read));
  require(launcher::parse_last_position(line).has_value());
}
std::vector<Bytes> last_positions() {
  return {bytes_of(launcher::to_line(
      launcher::LastPosition{.robot = RobotId(7),
                             .known = {.at = UtcTime(std::chrono::seconds(1'700'000'000)),
                                       .position_m = {1, 2},
                                       .command_mps = Vec2(0.5, 0),
                                       .speed_mps = 0.5}}))};
}

std::vector<Bytes> offers() {
  return {bytes_of(launcher::to_line({.run = {.relays = 4},
                                      .first_robot = 8,
                                      .robots = 4,
                                      .mission_yaml = kYard,
                                      .sent_at = UtcTime(std::chrono::seconds(1'700'000'000))})),
          bytes_of(R"({"refused": "the mission has begun"})")};
}

void plan_json(Input bytes) {
  const auto plan = plan_from_json(text_of(bytes));
  if (plan) require(plan_from_json(to_json(*plan)).has_value());
}
std::vector<Bytes> plan_jsons() {
  return {bytes_of(
      R"({"nodes": [{"mean_m": [1, 1], "covariance_m2": [[1, 0], [0, 1]], "time_s": 0, "mass": 1},
 {"mean_m": [9, 1], "covariance_m2": [[1, 0], [0, 1]], "time_s": 8, "mass": 1}], "legs": [{"from": 0, "to": 1, "mass": 1}]})")};
}

void view_request(Input bytes) {
  (void)monitor::parse_page_request(text_of(bytes));
  (void)monitor::parse_foxglove_request(text_of(bytes));
}
std::vector<Bytes> view_requests() {
  return {bytes_of(R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 2}]})"),
          bytes_of(R"({"op": "unsubscribe", "subscriptionIds": [1]})"),
          bytes_of(R"({"want": "frame"})"), bytes_of(R"({"command": "pause"})")};
}

// Datagrams and samples of the bus. The first byte of a sample's input chooses the message.

void rtps(Input bytes) {
  std::vector<std::byte> datagram(raw(bytes).begin(), raw(bytes).end());
  const auto payload = link::decode_rtps(datagram);
  if (!payload) return;
  link::CellStatesMessage states;
  (void)link::decode(*payload, states);
}
std::vector<Bytes> datagrams() {
  Rng rng(1);
  std::vector<std::byte> payload, datagram;
  require(link::encode(link::conformance::sample<link::CellStatesMessage>(rng), payload));
  link::encode_rtps({}, 7, payload, datagram);
  const auto* const begin = reinterpret_cast<const std::uint8_t*>(datagram.data());
  return {Bytes(begin, begin + datagram.size())};
}

link::Gate gate() {
  return link::Gate({.limits = {.robots = 12,
                                .bounds_m = {.min_m = {0.0, 0.0}, .max_m = {40.0, 30.0}},
                                .clock_skew_refuse = std::chrono::seconds(10)}});
}
constexpr UtcTime kNow{std::chrono::seconds(1'700'000'000)};

/// Decodes; a message that is one can be encoded again and goes through the gate.
template <class M, class Pass>
void one_message(std::span<const std::byte> bytes, Pass pass) {
  M message;
  if (!link::decode(bytes, message)) return;
  std::vector<std::byte> again;
  // Sequences beyond their bounds are decoded, and refused by the gate.
  require(link::encode(message, again) == link::fits_wire(message));
  link::Gate checks = gate();
  pass(checks, message);
}

void sample(Input bytes) {
  if (bytes.empty()) return;
  using link::Gate;
  const auto body = raw(bytes.subspan(1));
  switch (bytes[0] % 7) {
    case 0:
      return one_message<link::PlanMessage>(body, [](Gate& g, auto& m) { (void)g.plan(m, kNow); });
    case 1:
      return one_message<link::SceneMessage>(body,
                                             [](Gate& g, auto& m) { (void)g.scene(m, kNow); });
    case 2:
      return one_message<link::HeartbeatMessage>(
          body, [](Gate& g, auto& m) { (void)g.heartbeat(m, kNow); });
    case 3:
      return one_message<link::CommandMessage>(body,
                                               [](Gate& g, auto& m) { (void)g.command(m, kNow); });
    case 4:
      return one_message<link::StatusMessage>(body,
                                              [](Gate& g, auto& m) { (void)g.status(m, kNow); });
    case 5:
      return one_message<link::EventMessage>(body, [](Gate& g, auto& m) { (void)g.event(m); });
    default:
      return one_message<link::CellStatesMessage>(body, [](Gate& g, auto& m) {
        if (!g.batch(m)) return;
        for (const link::RobotStateMessage& state : m.states) (void)g.state(state, kNow);
      });
  }
}

template <class M>
void add_sample(std::uint8_t number, std::vector<Bytes>& out) {
  Rng rng(number + 1U);
  std::vector<std::byte> encoded;
  require(link::encode(link::conformance::sample<M>(rng), encoded));
  Bytes bytes = {number};
  const auto* const begin = reinterpret_cast<const std::uint8_t*>(encoded.data());
  bytes.insert(bytes.end(), begin, begin + encoded.size());
  out.push_back(std::move(bytes));
}
std::vector<Bytes> samples() {
  std::vector<Bytes> out;
  add_sample<link::PlanMessage>(0, out);
  add_sample<link::SceneMessage>(1, out);
  add_sample<link::HeartbeatMessage>(2, out);
  add_sample<link::CommandMessage>(3, out);
  add_sample<link::StatusMessage>(4, out);
  add_sample<link::EventMessage>(5, out);
  add_sample<link::CellStatesMessage>(6, out);
  return out;
}

// Recordings.

void recording(Input bytes) {
  const MemoryFile file(bytes);
  std::size_t read = 0;
  const mcap::Handlers handlers{
      .message = [&](const mcap::Message&, const mcap::Channel&, const mcap::Schema&) { ++read; },
      .attachment = [&](const mcap::Attachment&) { ++read; },
      .metadata = [&](const mcap::Metadata&) { ++read; }};
  (void)mcap::read(file.path(), handlers);
  (void)robot_log::read_records(file.path(), [&](const robot_log::Record&) { ++read; });
}
std::vector<Bytes> recordings() {
  const auto file = std::filesystem::temp_directory_path() /
                    ("swarmflow-fuzz-" + std::to_string(::getpid()) + ".mcap");
  robot_log::Batch batch;
  batch.append(robot_log::Step{.stamp = kNow, .position_m = {1.0, 2.0}});
  batch.append(robot_log::Note{.stamp = kNow, .code = "mode", .text = "moving"});
  require(batch.write(file).has_value());
  const Bytes bytes = bytes_of(content(file));
  std::filesystem::remove(file);
  return {bytes};
}

void log_record(Input bytes) {
  if (bytes.empty()) return;
  const auto record = robot_log::decode(bytes[0] % robot_log::kinds().size(), bytes.subspan(1));
  if (!record) return;
  std::vector<unsigned char> again;
  robot_log::encode(record->robot, record->record, again);
  require(robot_log::decode(record->record.index(), again).has_value());
}
std::vector<Bytes> log_records() {
  std::vector<Bytes> out;
  const std::vector<robot_log::Record> records = {
      robot_log::Step{.stamp = kNow, .position_m = {1.0, 2.0}},
      robot_log::Estimate{.stamp = kNow, .neighbour = RobotId(3), .position_m = {1.0, 2.0}},
      robot_log::LinkStats{.stamp = kNow, .refused = {1, 2, 3}},
      robot_log::Note{.stamp = kNow, .code = "mode", .text = "moving"}};
  for (const robot_log::Record& record : records) {
    Bytes bytes = {static_cast<std::uint8_t>(record.index())};
    std::vector<unsigned char> encoded;
    robot_log::encode(RobotId(2), record, encoded);
    bytes.insert(bytes.end(), encoded.begin(), encoded.end());
    out.push_back(std::move(bytes));
  }
  return out;
}

}  // namespace

const std::vector<Decoder>& decoders() {
  static const std::vector<Decoder> all = {{"mission", mission, missions},
                                           {"scene_change", scene_change, scene_changes},
                                           {"small_texts", small_texts, small_text_seeds},
                                           {"offer", offer, offers},
                                           {"last_position", last_position, last_positions},
                                           {"plan_json", plan_json, plan_jsons},
                                           {"view_request", view_request, view_requests},
                                           {"rtps", rtps, datagrams},
                                           {"sample", sample, samples},
                                           {"recording", recording, recordings},
                                           {"log_record", log_record, log_records}};
  return all;
}

const Decoder* decoder_named(std::string_view name) {
  for (const Decoder& decoder : decoders()) {
    if (decoder.name == name) return &decoder;
  }
  return nullptr;
}

}  // namespace swarm::fuzz
