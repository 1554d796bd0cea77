// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/page_session.hpp"

#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace swarm::monitor {
namespace {

using Json = nlohmann::json;

/// Size of a text message at most: a long recording's events are sent in parts, and frames pass
/// between them.
constexpr std::size_t kMaxText = 256 * 1024;
/// Answers that wait at most: a page reads the answers to its commands, so a client that does not
/// is refused.
constexpr std::size_t kMaxAnswers = 16;

constexpr std::array<std::pair<std::string_view, ControlAction>, 5> kActions = {
    {{"pause", ControlAction::kPause},
     {"resume", ControlAction::kResume},
     {"stop", ControlAction::kStop},
     {"goal", ControlAction::kGoal},
     {"add_obstacle", ControlAction::kAddObstacle}}};

tl::unexpected<Error> bad(std::string message) {
  return fail(ErrorCode::kBadInput, std::move(message));
}

/// A finite number under a key, or the error that names the key.
Result<double> number(const Json& json, const char* key) {
  const auto at = json.find(key);
  if (at == json.end() || !at->is_number()) return bad(fmt::format("{} must be a number", key));
  const double value = at->get<double>();
  if (!std::isfinite(value)) return bad(fmt::format("{} must be finite", key));
  return value;
}

Result<std::string> text_of(const Json& json, const char* key) {
  const auto at = json.find(key);
  if (at == json.end() || !at->is_string()) return bad(fmt::format("{} must be a text", key));
  return at->get<std::string>();
}

Result<PageRequest> parse_frame(const Json& json) {
  if (!json.contains("t")) return FrameRequest{};
  const auto time_s = number(json, "t");
  if (!time_s) return tl::unexpected(time_s.error());
  return FrameRequest{*time_s};
}

Result<PageRequest> parse_focus(const Json& json) {
  const auto robot = json.find("robot");
  if (robot == json.end()) return bad("focus needs a robot, or null");
  if (robot->is_null()) return FocusRequest{};
  // 0xFFFFFFFF stands for "no robot" in a frame.
  if (!robot->is_number_unsigned() || robot->get<std::uint64_t>() >= 0xFFFFFFFFU) {
    return bad("robot must be a robot's number");
  }
  return FocusRequest{RobotId(robot->get<std::uint32_t>())};
}

/// The token is checked by the server, not here: parsing depends on the text alone.
Result<PageRequest> parse_control(const Json& json) {
  ControlRequest request;
  const auto action = text_of(json, "action");
  if (!action) return tl::unexpected(action.error());
  const auto* known = kActions.begin();
  while (known != kActions.end() && known->first != *action) ++known;
  if (known == kActions.end()) return bad("unknown action");
  request.action = known->second;

  auto token = text_of(json, "token");
  if (!token) return tl::unexpected(token.error());
  request.token = std::move(*token);

  const auto want = [&](const char* key, double& into) -> Result<void> {
    const auto value = number(json, key);
    if (!value) return tl::unexpected(value.error());
    into = *value;
    return {};
  };
  if (request.action == ControlAction::kGoal || request.action == ControlAction::kAddObstacle) {
    if (const auto x = want("x", request.x_m); !x) return tl::unexpected(x.error());
    if (const auto y = want("y", request.y_m); !y) return tl::unexpected(y.error());
  }
  if (request.action == ControlAction::kAddObstacle) {
    if (const auto r = want("radius", request.radius_m); !r) return tl::unexpected(r.error());
    if (request.radius_m <= 0.0) return bad("radius must be positive");
  }
  return request;
}

/// Appends as many elements from `from` on as fit one message, at least one; returns their number.
std::size_t append_some(std::string& text, const std::vector<std::string>& elements,
                        std::size_t from) {
  std::size_t count = 0;
  for (; from + count < elements.size(); ++count) {
    const std::string& element = elements[from + count];
    if (count > 0 && text.size() + element.size() > kMaxText) break;
    if (count > 0) text += ',';
    text += element;
  }
  return count;
}

}  // namespace

std::string_view name_of(ControlAction action) {
  for (const auto& [name, known] : kActions) {
    if (known == action) return name;
  }
  return "";
}

Result<PageRequest> parse_page_request(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return bad("not a JSON object");
  const auto op = text_of(json, "op");
  if (!op) return tl::unexpected(op.error());
  if (*op == "frame") return parse_frame(json);
  if (*op == "focus") return parse_focus(json);
  if (*op == "control") return parse_control(json);
  return bad("unknown op");
}

void PageSession::take(std::string_view frame, bool binary) {
  if (binary) return refuse("the page sends text only");
  const auto request = parse_page_request(frame);
  if (!request) return refuse(request.error().message);
  if (const auto* wanted = std::get_if<FrameRequest>(&*request)) {
    wanted_ = *wanted;
  } else if (const auto* focus = std::get_if<FocusRequest>(&*request)) {
    focus_ = focus->robot;
  } else if (const auto* control = std::get_if<ControlRequest>(&*request)) {
    apply(*control);
  }
}

void PageSession::refuse(const std::string&) { count_refused(); }

/// Every refused action counts, so that a client cannot try many tokens: after 20 refusals the
/// server closes the connection.
void PageSession::apply(const ControlRequest& request) {
  if (answers_.size() >= kMaxAnswers) return refuse("does not read its answers");
  const auto done = control_(request);
  if (!done) count_refused();  // a token is not to be guessed
  const Json answer{{"op", done ? "done" : "refused"},
                    {"action", name_of(request.action)},
                    {"text", done ? *done : done.error().message}};
  answers_.push_back(answer.dump(-1, ' ', false, Json::error_handler_t::replace));
}

bool PageSession::has_something() const {
  return wanted_ || !answers_.empty() || scenes_sent_ < source_.scenes().size() ||
         events_sent_ < source_.events().size() || rows_sent_ < source_.series().size();
}

/// Answers first, then scenes, events and rows, and a frame only if the page requested one: text
/// that explains a frame arrives before it.
bool PageSession::next(Outgoing& out) {
  if (!answers_.empty()) {
    out.set_text(answers_.front());
    answers_.pop_front();
    return true;
  }
  if (next_scene(out) || next_events(out) || next_series(out)) return true;
  if (!wanted_) return false;
  out.binary = true;
  source_.view_frame(wanted_->time_s, focus_, out.bytes);
  wanted_.reset();
  ++counters().view_frames_sent;
  return true;
}

bool PageSession::next_scene(Outgoing& out) {
  const auto& scenes = source_.scenes();
  if (scenes_sent_ >= scenes.size()) return false;
  // Only a recording needs its earlier scenes, since one can move back in it.
  if (source_.live()) scenes_sent_ = scenes.size() - 1;
  out.set_text(scenes[scenes_sent_++]);
  return true;
}

bool PageSession::next_events(Outgoing& out) {
  if (events_sent_ >= source_.events().size()) return false;
  std::string text = R"({"op":"events","events":[)";
  events_sent_ += append_some(text, source_.events(), events_sent_);
  out.set_text(text + "]}");
  return true;
}

bool PageSession::next_series(Outgoing& out) {
  if (rows_sent_ >= source_.series().size()) return false;
  std::string text = fmt::format(
      R"({{"op":"series","from":{},"names":["t","nearest_gap_m","arrived","moving","latency_ms","rate_hz"],"rows":[)",
      rows_sent_);
  rows_sent_ += append_some(text, source_.series(), rows_sent_);
  out.set_text(text + "]}");
  return true;
}

}  // namespace swarm::monitor
