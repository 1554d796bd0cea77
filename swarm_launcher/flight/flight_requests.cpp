// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Requests of users to a run in flight: commands and changes of the scene.
#include <algorithm>
#include <optional>

#include <fmt/format.h>

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
  const Result<std::string> changed =
      wanted ? change(*wanted, now.utc) : tl::unexpected(wanted.error());
  ports_.control.answer(
      request.client,
      changed ? "done: " + *changed : changed.error().message + "\nfailed: nothing changed");
}

// A stop is answered only when all robots have confirmed it, see answer_stops().
void FlightLoop::serve_command(CommandKind kind, ControlRequests::ClientId client, SteadyTime now) {
  supervisor_.on_command(kind, now);
  if (ports_.hosts != nullptr) ports_.hosts->on_user_command(kind);
  if (kind == CommandKind::kStop) {
    stopping_.push_back(client);
    return;
  }
  ports_.control.answer(client, fmt::format("done: {} sent to {} robots", to_string(kind),
                                            ports_.bus.commands->matched()));
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
