// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Requests of users to a run in flight: commands and changes of the scene.
#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "swarm_core/mission/goal_room.hpp"
#include "swarm_core/mission_file/scene_change_file.hpp"
#include "swarm_launcher/flight/flight_loop.hpp"

namespace swarm::launcher {
namespace {

std::optional<CommandKind> command_named(const std::string& name) {
  for (const CommandKind kind :
       {CommandKind::kStart, CommandKind::kPause, CommandKind::kResume, CommandKind::kStop}) {
    if (name == to_string(kind)) return kind;
  }
  return std::nullopt;
}

}  // namespace

void FlightLoop::serve_requests(const FlightTime& now) {
  for (const ControlRequests::Request& request : ports_.control.poll()) serve(request, now);
  answer_stops();
  for (const auto& [client, text] : confirmations_.due(supervisor_.lost(), now.steady)) {
    ports_.control.answer(client, text);
  }
}

// Checked here and not where the change is made: the scenes of recordings, which pass there, too,
// may be of versions that accepted them.
std::optional<std::string> FlightLoop::objection_to(const SceneChange& change) const {
  const Mission& mission = options_.mission;
  if (const auto* add = std::get_if<AddObstacle>(&change)) {
    return lack_of_place(add->shape, mission.world.bounds_m());
  }
  if (const auto* go_to = std::get_if<GoTo>(&change)) {
    return lack_of_goal_room(mission, {&go_to->goal, "goal"}, supervisor_.counts().lost);
  }
  return std::nullopt;
}

// The first token is a mission command or a kind of scene change.
void FlightLoop::serve(const ControlRequests::Request& request, const FlightTime& now) {
  const std::size_t space = std::min(request.line.find(' '), request.line.size());
  const std::string name = request.line.substr(0, space);
  if (const auto kind = command_named(name)) {
    serve_command(*kind, request.client, now.steady);
    return;
  }
  auto wanted = parse_scene_change(name, request.line.substr(space), options_.mission.world);
  if (wanted && std::holds_alternative<AddBody>(*wanted)) {
    wanted = fail(ErrorCode::kBadInput, "add_body: the launcher alone adds bodies");
  }
  if (wanted) {
    if (auto objection = objection_to(*wanted)) {
      wanted = fail(ErrorCode::kBadInput, fmt::format("{}: {}", name, *objection));
    }
  }
  const Result<std::string> changed =
      wanted ? change(*wanted, now.utc) : tl::unexpected(wanted.error());
  ports_.control.answer(
      request.client,
      changed ? "done: " + *changed : changed.error().message + "\nfailed: nothing changed");
}

// A stop is answered only when all robots have confirmed it, see answer_stops(), the others by
// Confirmations. A command that does not apply in a phase changes nothing, and nothing is
// confirmed.
void FlightLoop::serve_command(CommandKind kind, ControlRequests::ClientId client, SteadyTime now) {
  const MissionPhase before = supervisor_.phase();
  supervisor_.on_command(kind, now);
  if (ports_.hosts != nullptr) ports_.hosts->on_user_command(kind);
  if (kind == CommandKind::kStop) {
    stopping_.push_back(client);
    return;
  }
  if (phase_after(before, kind) == before) {
    ports_.control.answer(
        client, fmt::format("done: {} sent; it changes nothing, the mission is {}", to_string(kind),
                            to_string(before)));
    return;
  }
  confirmations_.wait_for(client, kind, now);
}

// Answers waiting stop requests: when no robot is left that has not confirmed, or when the
// supervisor gives up and ends the run. A run that ends for another reason takes no commands.
void FlightLoop::answer_stops() {
  const bool ending = supervisor_.stage() == Supervisor::Stage::kEnding;
  const bool stopped = supervisor_.phase() == MissionPhase::kStopped;
  if (stopping_.empty() || (!stopped && !ending)) return;
  const auto unstopped = supervisor_.unstopped();
  if (stopped && !unstopped.empty() && !ending) return;
  std::string answer = "failed: the run is ending, no stop was sent";
  if (stopped && unstopped.empty()) {
    answer = fmt::format("done: {} robots confirmed the stop", supervisor_.counts().stopped);
  } else if (stopped) {
    answer = "failed: stop not confirmed by robots " + describe(unstopped);
  }
  for (const ControlRequests::ClientId client : stopping_) ports_.control.answer(client, answer);
  stopping_.clear();
}

}  // namespace swarm::launcher
