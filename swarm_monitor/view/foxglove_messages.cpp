// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/foxglove_messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <nlohmann/json.hpp>

#include "swarm_monitor/view/cdr_writer.hpp"

namespace swarm::monitor::foxglove {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kFrame = "map";
constexpr double kFlat_m = 0.02;     // height of what has none
constexpr double kObstacle_m = 1.0;  // height of a circle
constexpr double kOutline_m = 0.15;  // width of a polygon's outline
constexpr std::uint32_t kLineLoop = 1;

struct Rgba {
  double r, g, b, a;
};
constexpr Rgba kObstacleColor = {0.45, 0.45, 0.5, 1.0};

struct Cylinder {
  double x_m, y_m, heading;
  double width_m, depth_m, height_m;
  Rgba color;
};

struct Outline {
  std::vector<std::pair<double, double>> points_m;
};

/// Seconds and nanoseconds since 1970; times before that count as 0.
void put_time(CdrWriter& cdr, UtcTime time) {
  const auto ns =
      static_cast<std::uint64_t>(std::max<std::int64_t>(time.time_since_epoch().count(), 0));
  cdr.put(static_cast<std::uint32_t>(ns / 1'000'000'000U));
  cdr.put(static_cast<std::uint32_t>(ns % 1'000'000'000U));
}

void put_vector(CdrWriter& cdr, double x, double y, double z) {
  cdr.put(x);
  cdr.put(y);
  cdr.put(z);
}

/// A rotation by `heading` about the vertical axis as the quaternion (0, 0, sin ½h, cos ½h).
void put_pose(CdrWriter& cdr, double x_m, double y_m, double z_m, double heading) {
  put_vector(cdr, x_m, y_m, z_m);
  put_vector(cdr, 0.0, 0.0, std::sin(heading / 2.0));
  cdr.put(std::cos(heading / 2.0));
}

void put_color(CdrWriter& cdr, const Rgba& color) {
  put_vector(cdr, color.r, color.g, color.b);
  cdr.put(color.a);
}

void put_cylinder(CdrWriter& cdr, const Cylinder& c) {
  put_pose(cdr, c.x_m, c.y_m, c.height_m / 2.0, c.heading);
  put_vector(cdr, c.width_m, c.depth_m, c.height_m);
  cdr.put(1.0);  // as wide below as above
  cdr.put(1.0);
  put_color(cdr, c.color);
}

void put_outline(CdrWriter& cdr, const Outline& outline) {
  cdr.put(kLineLoop);
  put_pose(cdr, 0.0, 0.0, 0.0, 0.0);
  cdr.put(kOutline_m);
  cdr.put_bool(false);  // in metres
  cdr.put_length(outline.points_m.size());
  for (const auto& [x_m, y_m] : outline.points_m) put_vector(cdr, x_m, y_m, 0.0);
  put_color(cdr, kObstacleColor);
  cdr.put_length(0);  // colors
  cdr.put_length(0);  // indices
}

/// A scene update with one entity, which replaces the entity of the same id. The order of the
/// fields is that of the schema.
Bytes scene_update(UtcTime now, std::string_view id, const std::vector<Cylinder>& cylinders,
                   const std::vector<Outline>& outlines) {
  CdrWriter cdr;
  cdr.put_length(0);  // deletions
  cdr.put_length(1);  // entities
  put_time(cdr, now);
  cdr.put_string(kFrame);
  cdr.put_string(id);
  cdr.put(std::int32_t{0});  // lifetime: until replaced
  cdr.put(std::uint32_t{0});
  cdr.put_bool(false);  // frame_locked
  cdr.put_length(0);    // metadata
  cdr.put_length(0);    // arrows
  cdr.put_length(0);    // cubes
  cdr.put_length(0);    // spheres
  cdr.put_length(cylinders.size());
  for (const Cylinder& cylinder : cylinders) put_cylinder(cdr, cylinder);
  cdr.put_length(outlines.size());
  for (const Outline& outline : outlines) put_outline(cdr, outline);
  cdr.put_length(0);  // triangles
  cdr.put_length(0);  // texts
  cdr.put_length(0);  // models
  return cdr.take();
}

/// The ellipse of two standard deviations: eigenvalues mean ± spread of the covariance are the
/// variances along its main axes. The opacity grows with the component's weight.
Cylinder ellipse(const ViewFrame::Component& c) {
  const double mean = (static_cast<double>(c.xx) + static_cast<double>(c.yy)) / 2.0;
  const double half = (static_cast<double>(c.xx) - static_cast<double>(c.yy)) / 2.0;
  const double xy = static_cast<double>(c.xy);
  const double spread = std::hypot(half, xy);
  const double heaviness = std::clamp(static_cast<double>(c.weight), 0.0, 1.0);
  return {.x_m = c.x_m,
          .y_m = c.y_m,
          .heading = std::atan2(xy, half) / 2.0,
          .width_m = 4.0 * std::sqrt(std::max(mean + spread, 0.0)),
          .depth_m = 4.0 * std::sqrt(std::max(mean - spread, 0.0)),
          .height_m = kFlat_m,
          .color = {.r = 0.2, .g = 0.5, .b = 0.9, .a = 0.15 + 0.35 * heaviness}};
}

bool is_numbers(const Json& json, std::size_t count) {
  return json.is_array() && json.size() == count &&
         std::all_of(json.begin(), json.end(), [](const Json& n) { return n.is_number(); });
}

}  // namespace

Bytes poses_in_frame(UtcTime now, const ViewFrame& view_frame) {
  CdrWriter cdr;
  put_time(cdr, now);
  cdr.put_string(kFrame);
  cdr.put_length(static_cast<std::size_t>(
      std::count_if(view_frame.robots.begin(), view_frame.robots.end(),
                    [](const ViewFrame::Robot& robot) { return robot.was_received; })));
  for (const ViewFrame::Robot& robot : view_frame.robots) {
    if (!robot.was_received) continue;
    put_pose(cdr, robot.x_m, robot.y_m, 0.0, static_cast<double>(robot.heading));
  }
  return cdr.take();
}

Bytes mixture_scene(UtcTime now, const ViewFrame& view_frame) {
  std::vector<Cylinder> ellipses;
  ellipses.reserve(view_frame.mixture.size());
  for (const ViewFrame::Component& component : view_frame.mixture) {
    ellipses.push_back(ellipse(component));
  }
  return scene_update(now, "mixture", ellipses, {});
}

/// Reads the page's own scene message, so that the page and Foxglove show the same obstacles.
/// Malformed obstacles are skipped.
Bytes obstacles_scene(UtcTime now, std::string_view scene_json) {
  std::vector<Cylinder> circles;
  std::vector<Outline> polygons;
  const Json scene = Json::parse(scene_json, nullptr, false);
  const Json obstacles =
      scene.is_object() ? scene.value("obstacles", Json::array()) : Json::array();
  for (const Json& obstacle : obstacles) {
    if (!obstacle.is_object()) continue;
    if (const auto circle = obstacle.find("circle");
        circle != obstacle.end() && is_numbers(*circle, 3)) {
      const double diameter_m = 2.0 * (*circle)[2].get<double>();
      circles.push_back({.x_m = (*circle)[0].get<double>(),
                         .y_m = (*circle)[1].get<double>(),
                         .heading = 0.0,
                         .width_m = diameter_m,
                         .depth_m = diameter_m,
                         .height_m = kObstacle_m,
                         .color = kObstacleColor});
    }
    if (const auto polygon = obstacle.find("polygon");
        polygon != obstacle.end() && polygon->is_array()) {
      Outline outline;
      for (const Json& point : *polygon) {
        if (!is_numbers(point, 2)) continue;
        outline.points_m.emplace_back(point[0].get<double>(), point[1].get<double>());
      }
      polygons.push_back(std::move(outline));
    }
  }
  return scene_update(now, "obstacles", circles, polygons);
}

}  // namespace swarm::monitor::foxglove
