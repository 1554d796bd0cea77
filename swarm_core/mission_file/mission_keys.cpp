// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/mission_keys.hpp"

#include <array>
#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "swarm_core/mission_file/reader_bounds.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/section_key.hpp"

namespace swarm {
namespace {

/// One key in the table of the documentation.
struct Row {
  std::string_view key;
  std::string_view kind;
  std::string range;
  std::string fallback;
  std::string_view doc;
};

/// The accepted values of a key, without the "must be" of error messages.
std::string range_text(const Range& range) {
  constexpr std::string_view kVerb = "must be ";
  return to_string(range).substr(kVerb.size());
}

/// Escapes bars, which would end the cell of a Markdown table.
std::string cell(std::string_view text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

/// Builds the Markdown text. A table starts with the first row after a heading, so that a component
/// without options has a heading only.
class Page {
 public:
  void heading(std::string_view level, std::string_view name, std::string_view doc) {
    text_ += fmt::format("\n{} {}\n\n{}.\n", level, name, doc);
    has_table_ = false;
  }

  void add(std::string_view section, const Row& row) {
    if (!has_table_) {
      text_ +=
          "\n| section | key | kind | range | default | meaning |\n|---|---|---|---|---|---|\n";
    }
    has_table_ = true;
    text_ += fmt::format("| {} | `{}` | {} | {} | {} | {} |\n", section, row.key, row.kind,
                         cell(row.range), row.fallback, cell(row.doc));
  }

  template <class Section, std::size_t N>
  void add(std::string_view name, const std::array<SectionKey<Section>, N>& fields) {
    // Static: g++ 12 takes the members of a local one for uninitialised in the branches of other
    // types.
    static const Section defaults{};
    for (const auto& field : fields) {
      Row row{field.key, "number", range_text(field.range), {}, field.doc};
      // Kind and default follow from the type of the member, so tables and documentation cannot
      // differ.
      std::visit(
          [&](auto member) {
            using Value = std::remove_cvref_t<decltype(defaults.*member)>;
            if constexpr (std::is_same_v<Value, std::optional<double>>) {
              row.fallback = "not judged";  // a number that may be left out has no other default
            } else if constexpr (std::is_same_v<Value, LauncherLoss>) {
              row.kind = "choice";
              row.range = fmt::format("{}", fmt::join(kLauncherLosses, ", "));
              row.fallback = to_string(defaults.*member);
            } else {
              row.fallback = fmt::format("{}", defaults.*member);
              if constexpr (std::is_integral_v<Value>) row.kind = "count";
            }
          },
          field.member);
      add(name, row);
    }
  }

  void add(std::string_view section, const Components& components) {
    for (const ComponentSpec& component : components) {
      heading("###", fmt::format("{}: {}", section, component.name), component.doc);
      for (const OptionSpec& option : component.options) add(section, row_of(option));
    }
  }

  std::string take() { return std::move(text_); }

 private:
  static Row row_of(const OptionSpec& option) {
    Row row{option.key, "number", range_text(option.range), option.fallback, option.doc};
    if (option.kind == OptionSpec::Kind::kCount) row.kind = "count";
    if (option.kind == OptionSpec::Kind::kText) {
      row.kind = "text";
      row.range = fmt::format("at most {} characters", kMaxOptionText);
    }
    if (option.kind == OptionSpec::Kind::kChoice) {
      row.kind = "choice";
      row.range = fmt::format("{}", fmt::join(option.choices, ", "));
    }
    if (!option.at_most.empty()) row.range += fmt::format(", <= {}", option.at_most);
    return row;
  }

  std::string text_ =
      "<!-- Made by `swarm_launcher keys`: edit the tables in the code, not this file. "
      "-->\n# Keys of a mission file\n\nThe keys that have a single value; the others are in "
      "[mission-file.md](mission-file.md). A section or key that "
      "is left out has its default. Keys of components that the mission does not choose are "
      "allowed. `swarm_launcher --check MISSION.yaml` lists all errors in a file.\n";
  bool has_table_ = false;
};

std::string names_of(const Components& components) {
  std::string names;
  for (const ComponentSpec& component : components) {
    names += (names.empty() ? "" : ", ") + component.name;
  }
  return names;
}

/// The row of a key that names a component.
Row named(std::string_view key, const Components& components, const std::string& fallback,
          std::string_view doc) {
  return {key, "choice", names_of(components), fallback, doc};
}

/// The row of a key that is a number or `auto`.
Row automatic(std::string_view key, const Range& range, std::string_view doc) {
  return {key, "number or auto", range_text(range), std::string(reader_bounds::kAutomatic), doc};
}

void add_robots(Page& page, const Components& drivers) {
  page.heading("##", "robots",
               "The robots' bodies; a group in robots.groups may have other values for its robots");
  page.add("robots", kRobotsKeys);
  page.add("robots", named("model", drivers, BodySpec{}.model, "the driver of the body"));
  page.add("robots", kBodyKeys);
  page.add("robots",
           automatic("lag_s", reader_bounds::kLag_s,
                     "time until the body moves as commanded; auto: as its driver declares"));
  page.add("robots", drivers);
}

void add_planner(Page& page, const Components& methods) {
  page.heading("##", "planner", "Keys of every planning method");
  page.add("planner", named("method", methods, PlannerSpec{}.method, "the planning method"));
  page.add("planner", automatic("density_cap_per_m2", reader_bounds::kDensityCap_per_m2,
                                "swarmprm and rover: robots per m2 at most; 0: no cap; auto: "
                                "swarmprm plans what the bodies can follow, rover without a cap"));
  page.add("planner", kPlannerKeys);
  page.add("planner", methods);
}

void add_control(Page& page, const Components& methods) {
  page.heading("##", "control", "Keys of every control method");
  page.add("control", named("method", methods, ControlSpec{}.method, "the control method"));
  page.add("control", kControlKeys);
  page.add("control",
           automatic("shape_tolerance_m2", reader_bounds::kShapeTolerance_m2,
                     "robots fill the drawing of the goal and have arrived within this tolerance "
                     "of its shape function; auto: as the method declares, else robots arrive in "
                     "their component of the goal"));
  page.add("control", methods);
}

}  // namespace

/// Sections in the order in which a mission file has them.
std::string mission_keys_markdown(const Catalogue& catalogue) {
  Page page;
  add_robots(page, catalogue.drivers);
  add_planner(page, catalogue.planning_methods);
  add_control(page, catalogue.control_methods);
  page.heading("##", "safety", "The safety filter, which every command passes");
  page.add("safety", kSafetyKeys);
  page.heading("##", "link", "Which states robots receive and how often they send their own");
  page.add("link", kLinkKeys);
  page.heading("##", "timing", "Heartbeats, silence and clocks");
  page.add("timing", kTimingKeys);
  page.heading("##", "plan_clock", "How far the plan's clock slows down when the swarm lags");
  page.add("plan_clock", kPlanClockKeys);
  page.heading("##", "launcher", "Start of the processes, waiting for them, restart");
  page.add("launcher", kLauncherKeys);
  page.heading("##", "criteria",
               "What the audit demands of a run beyond arrival and no contact; a key that is left "
               "out is not judged");
  page.add("criteria", kCriteriaKeys);
  return page.take();
}

}  // namespace swarm
