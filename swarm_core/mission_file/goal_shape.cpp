// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/goal_shape.hpp"

#include <array>
#include <vector>

#include <fmt/format.h>

#include "swarm_core/gmm/fit_mixture.hpp"
#include "swarm_core/gmm/image_boxes.hpp"
#include "swarm_core/gmm/shape_patches.hpp"
#include "swarm_core/mission_file/bitmap_file.hpp"
#include "swarm_core/mission_file/reader_bounds.hpp"

namespace swarm {
namespace {

using reader_bounds::kCoordinate_m;
using yaml::MapReader;
using yaml::Node;

// A goal is read before the seed of the run is known, and must be the same in every run.
constexpr std::uint64_t kFitSeed = 20240216;
// The fit's time grows with both.
constexpr std::size_t kMaxShapeVertices = 1'000;
constexpr double kMaxChosenComponents = 64;

// Reads all points before it gives up, so that every wrong one is reported.
std::optional<Polygon> read_vertices(const Node& node, const std::string& path,
                                     yaml::Violations& violations) {
  const auto* items = yaml::read_list(node, path, 3, kMaxShapeVertices, violations);
  if (items == nullptr) return std::nullopt;
  std::vector<Vec2> vertices_m;
  for (std::size_t i = 0; i < items->size(); ++i) {
    const auto p = yaml::read_numbers((*items)[i], fmt::format("{}[{}]", path, i), 2, kCoordinate_m,
                                      violations);
    if (p) vertices_m.emplace_back((*p)[0], (*p)[1]);
  }
  if (vertices_m.size() != items->size()) return std::nullopt;
  auto polygon = Polygon::make(std::move(vertices_m));
  if (polygon) return *std::move(polygon);
  violations.add(node.at, fmt::format("{}: {}", path, polygon.error().message));
  return std::nullopt;
}

// Reads one drawn goal: its outline or picture, how to fit it, then fits the mixture.
class GoalShapeReader {
 public:
  GoalShapeReader(std::filesystem::path directory, yaml::Violations& violations)
      : directory_(std::move(directory)), violations_(violations) {}

  // All keys are read before the first return: a file with several mistakes is reported in full.
  std::optional<DrawnGoal> read(const Node& node, const std::string& path) {
    MapReader keys(node, path, violations_);
    const Node* polygon = keys.take("polygon_m");
    const Node* bitmap = keys.take("bitmap");
    const auto options = read_options(keys);
    keys.finish();
    if ((polygon == nullptr) == (bitmap == nullptr)) {
      violations_.add(node.at, fmt::format("{} has {}; must have one of polygon_m and bitmap", path,
                                           polygon == nullptr ? "no shape" : "two shapes"));
      return std::nullopt;
    }
    const auto patches = polygon != nullptr ? read_polygon(*polygon, path + ".polygon_m")
                                            : read_bitmap(*bitmap, path + ".bitmap");
    if (!patches || !options) return std::nullopt;
    Rng rng(kFitSeed);
    auto fit = fit_mixture(*patches, *options, rng);
    if (fit) return DrawnGoal{std::move(fit->mixture), std::move(shape_)};
    violations_.add(node.at, fmt::format("{}: {}", path, fit.error().message));
    return std::nullopt;
  }

 private:
  // The number of components that the user sets may be larger than the one that the BIC may choose,
  // because the search fits every number up to its bound.
  std::optional<FitOptions> read_options(MapReader& keys) {
    FitOptions options;
    bool good = true;
    const auto set = [&](auto& field, const auto& value) {
      good = good && value.has_value();
      if (value) field = *value;
    };
    if (const Node* value = keys.take("components")) {
      set(options.components,
          yaml::read_count(*value, keys.path_of("components"),
                           between(1, reader_bounds::kMaxComponents), violations_));
    }
    if (const Node* value = keys.take("components_max")) {
      set(options.components_max, yaml::read_count(*value, keys.path_of("components_max"),
                                                   between(1, kMaxChosenComponents), violations_));
    }
    if (const Node* value = keys.take("sigma_min_m")) {
      set(options.sigma_min_m,
          yaml::read_number(*value, keys.path_of("sigma_min_m"), between(0.01, 1000), violations_));
    }
    if (!good) return std::nullopt;
    return options;
  }

  std::optional<std::vector<Patch>> read_polygon(const Node& node, const std::string& path) {
    auto polygon = read_vertices(node, path, violations_);
    if (!polygon) return std::nullopt;
    auto patches = polygon_patches(*polygon);
    keep_shape({*std::move(polygon)}, {});
    return patches;
  }

  // A drawing that cannot become a field leaves `shape_` null: the mixture alone is still a goal.
  void keep_shape(std::vector<Polygon> polygons, std::vector<Box> boxes_m) {
    auto shape = ShapeField::make(std::move(polygons), std::move(boxes_m));
    if (shape) shape_ = std::make_shared<const ShapeField>(*std::move(shape));
  }

  std::optional<std::vector<Patch>> read_bitmap(const Node& node, const std::string& path) {
    MapReader keys(node, path, violations_);
    const Node* file_node = keys.take("file", true);
    std::optional<std::string> file;
    if (file_node != nullptr) file = yaml::read_text(*file_node, path + ".file", violations_);
    const auto frame = read_frame(keys);
    keys.finish();
    if (!file || !frame) return std::nullopt;
    // Transparent pixels do not belong to the shape: the background is the colour outside of it.
    const auto image = load_bitmap(directory_ / *file, frame->dark ? 255 : 0);
    if (!image) {
      violations_.add(file_node->at, fmt::format("{}.file: {}", path, image.error().message));
      return std::nullopt;
    }
    auto patches = image_patches(*image, *frame);
    if (!patches.empty()) {
      keep_shape({}, image_boxes(*image, *frame));
      return patches;
    }
    violations_.add(file_node->at,
                    fmt::format("{}.file: {} has no {} pixel; draw the shape, or set dark to {}",
                                path, *file, frame->dark ? "dark" : "bright", !frame->dark));
    return std::nullopt;
  }

  // Where the picture lies in the world; `dark` selects which pixels are the shape.
  std::optional<ImageFrame> read_frame(MapReader& keys) {
    ImageFrame frame;
    const Node* origin_node = keys.take("origin_m", true);
    const Node* pixel_node = keys.take("pixel_m", true);
    bool good = origin_node != nullptr && pixel_node != nullptr;
    if (origin_node != nullptr) {
      const auto origin =
          yaml::read_numbers(*origin_node, keys.path_of("origin_m"), 2, kCoordinate_m, violations_);
      good = good && origin.has_value();
      if (origin) frame.origin_m = {(*origin)[0], (*origin)[1]};
    }
    if (pixel_node != nullptr) {
      const auto pixel_m =
          yaml::read_number(*pixel_node, keys.path_of("pixel_m"), positive(1000), violations_);
      good = good && pixel_m.has_value();
      frame.pixel_m = pixel_m.value_or(frame.pixel_m);
    }
    if (const Node* value = keys.take("dark")) {
      static constexpr std::array<std::string_view, 2> kBooleans{"true", "false"};
      const auto text = yaml::read_choice(*value, keys.path_of("dark"), kBooleans, violations_);
      good = good && text.has_value();
      frame.dark = text != "false";
    }
    if (!good) return std::nullopt;
    return frame;
  }

  std::filesystem::path directory_;
  yaml::Violations& violations_;
  std::shared_ptr<const ShapeField> shape_;
};

}  // namespace

std::optional<DrawnGoal> read_goal_shape(const Node& node, const std::string& path,
                                         const std::filesystem::path& directory,
                                         yaml::Violations& violations) {
  return GoalShapeReader(directory, violations).read(node, path);
}

// The inverse of the writer in mission_yaml.cpp.
std::shared_ptr<const ShapeField> read_shape_field(const Node& node, const std::string& path,
                                                   yaml::Violations& violations) {
  MapReader keys(node, path, violations);
  bool good = keys.is_map();
  std::vector<Polygon> polygons;
  std::vector<Box> boxes_m;
  if (const Node* value = keys.take("polygons_m")) {
    const std::string list = keys.path_of("polygons_m");
    const auto* items = yaml::read_list(*value, list, 0, kShapeBoxes, violations);
    for (std::size_t i = 0; items != nullptr && i < items->size(); ++i) {
      auto polygon = read_vertices((*items)[i], fmt::format("{}[{}]", list, i), violations);
      if (polygon) polygons.push_back(*std::move(polygon));
    }
    good = good && items != nullptr && polygons.size() == items->size();
  }
  if (const Node* value = keys.take("boxes_m")) {
    const std::string list = keys.path_of("boxes_m");
    const auto* items = yaml::read_list(*value, list, 0, kShapeBoxes, violations);
    for (std::size_t i = 0; items != nullptr && i < items->size(); ++i) {
      const auto b = yaml::read_numbers((*items)[i], fmt::format("{}[{}]", list, i), 4,
                                        kCoordinate_m, violations);
      if (b) boxes_m.push_back({.min_m = {(*b)[0], (*b)[1]}, .max_m = {(*b)[2], (*b)[3]}});
    }
    good = good && items != nullptr && boxes_m.size() == items->size();
  }
  keys.finish();
  if (!good) return nullptr;
  auto shape = ShapeField::make(std::move(polygons), std::move(boxes_m));
  if (shape) return std::make_shared<const ShapeField>(*std::move(shape));
  violations.add(node.at, fmt::format("{}: {}", path, shape.error().message));
  return nullptr;
}

}  // namespace swarm
