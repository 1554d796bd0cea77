// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/mission/catalogue.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace swarm {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<OptionSpec::Kind, std::string_view>, 4> kKinds{
    {{OptionSpec::Kind::kNumber, "number"},
     {OptionSpec::Kind::kCount, "count"},
     {OptionSpec::Kind::kChoice, "choice"},
     {OptionSpec::Kind::kText, "text"}}};

// A choice has no range and a number no values, so only the keys that apply are written.
Json option_json(const OptionSpec& option) {
  const auto kind = std::find_if(kKinds.begin(), kKinds.end(),
                                 [&](const auto& k) { return k.first == option.kind; });
  Json json{{"key", option.key},
            {"kind", kind->second},
            {"default", option.fallback},
            {"doc", option.doc}};
  if (!option.at_most.empty()) json["at_most"] = option.at_most;
  if (option.kind == OptionSpec::Kind::kChoice) {
    json["choices"] = option.choices;
  } else if (option.kind != OptionSpec::Kind::kText) {
    json["low"] = option.range.low;
    json["high"] = option.range.high;
    json["low_open"] = option.range.low_open;
  }
  return json;
}

// Defaults of a lag and of a shape tolerance are left out to keep descriptions short.
Json components_json(const Components& components) {
  Json list = Json::array();
  for (const ComponentSpec& component : components) {
    Json options = Json::array();
    for (const OptionSpec& option : component.options) options.push_back(option_json(option));
    Json json{{"name", component.name}, {"doc", component.doc}, {"options", std::move(options)}};
    if (!(component.lag == LagSpec{})) {
      json["lag"] = {{"fixed_s", component.lag.fixed_s},
                     {"accelerates", component.lag.accelerates},
                     {"turns", component.lag.turns}};
    }
    if (!component.shape_tolerance.empty()) json["shape_tolerance"] = component.shape_tolerance;
    list.push_back(std::move(json));
  }
  return list;
}

// Throws nlohmann's exceptions for keys that are missing or of another type; catalogue_from_json()
// catches them.
// An unknown kind is read as a number, the default of OptionSpec.
OptionSpec option_from(const Json& json) {
  OptionSpec option{.key = json.at("key").get<std::string>(),
                    .fallback = json.at("default").get<std::string>(),
                    .doc = json.at("doc").get<std::string>(),
                    .at_most = json.value("at_most", "")};
  const auto word = json.at("kind").get<std::string>();
  const auto kind =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& k) { return k.second == word; });
  if (kind != kKinds.end()) option.kind = kind->first;
  if (option.kind == OptionSpec::Kind::kChoice) {
    option.choices = json.at("choices").get<std::vector<std::string>>();
  } else if (option.kind != OptionSpec::Kind::kText) {
    option.range = {.low = json.at("low").get<double>(),
                    .high = json.at("high").get<double>(),
                    .low_open = json.at("low_open").get<bool>()};
  }
  return option;
}

// Reads what components_json() writes; throws in the same way as option_from().
Components components_from(const Json& list) {
  Components components;
  for (const Json& json : list) {
    ComponentSpec component{.name = json.at("name").get<std::string>(),
                            .doc = json.at("doc").get<std::string>(),
                            .options = {}};
    for (const Json& option : json.at("options")) component.options.push_back(option_from(option));
    if (const auto lag = json.find("lag"); lag != json.end()) {
      component.lag = {.fixed_s = lag->at("fixed_s").get<double>(),
                       .accelerates = lag->at("accelerates").get<bool>(),
                       .turns = lag->at("turns").get<bool>()};
    }
    component.shape_tolerance = json.value("shape_tolerance", "");
    components.push_back(std::move(component));
  }
  return components;
}

}  // namespace

const ComponentSpec* find_component(const Components& components, std::string_view name) {
  const auto found = std::find_if(components.begin(), components.end(),
                                  [&](const ComponentSpec& c) { return c.name == name; });
  return found == components.end() ? nullptr : &*found;
}

Catalogue open_catalogue() {
  Catalogue catalogue;
  catalogue.planning_is_open = true;
  catalogue.robots_are_open = true;
  return catalogue;
}

std::string to_json(const Catalogue& catalogue) {
  return Json{{"planning_methods", components_json(catalogue.planning_methods)},
              {"control_methods", components_json(catalogue.control_methods)},
              {"drivers", components_json(catalogue.drivers)}}
      .dump(2);
}

// The text is the output of another program, possibly of another version: unknown keys are ignored.
Result<Catalogue> catalogue_from_json(std::string_view text, const std::string& name) {
  try {
    const Json json = Json::parse(text);
    Catalogue catalogue;
    catalogue.planning_methods = components_from(json.at("planning_methods"));
    catalogue.control_methods = components_from(json.at("control_methods"));
    catalogue.drivers = components_from(json.at("drivers"));
    return catalogue;
  } catch (const Json::exception& e) {
    return fail(ErrorCode::kBadInput,
                fmt::format("{}: its description of itself cannot be read: {}", name, e.what()));
  }
}

}  // namespace swarm
