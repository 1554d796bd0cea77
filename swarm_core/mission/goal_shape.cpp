// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/goal_shape.hpp"

#include <array>
#include <vector>

#include <fmt/format.h>

#include "swarm_core/gmm/fit_mixture.hpp"
#include "swarm_core/gmm/shape_patches.hpp"
#include "swarm_core/mission/bitmap_file.hpp"
#include "swarm_core/mission/mission_fields.hpp"

namespace swarm {
namespace {

using mission_fields::between;
using mission_fields::kMaxExtent_m;
using yaml::MapReader;
using yaml::Node;

// A goal is read before any seed is known, and must be the same in every run.
constexpr std::uint64_t kFitSeed = 20240216;
// The fit's time grows with both.
constexpr std::size_t kMaxShapeVertices = 1'000;
constexpr double kMaxChosenComponents = 64;
constexpr yaml::Range kCoordinate_m = between(-kMaxExtent_m, kMaxExtent_m);

class GoalShapeReader {
 public:
  GoalShapeReader(std::filesystem::path directory, yaml::Violations& violations)
      : directory_(std::move(directory)), violations_(violations) {}

  std::optional<Mixture> read(const Node& node, const std::string& path) {
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
    if (fit) return std::move(fit->mixture);
    violations_.add(node.at, fmt::format("{}: {}", path, fit.error().message));
    return std::nullopt;
  }

 private:
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
                           between(1, mission_fields::kMaxComponents), violations_));
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
    const auto* items = yaml::read_list(node, path, 3, kMaxShapeVertices, violations_);
    if (items == nullptr) return std::nullopt;
    std::vector<Vec2> vertices_m;
    for (std::size_t i = 0; i < items->size(); ++i) {
      const auto p = yaml::read_numbers((*items)[i], fmt::format("{}[{}]", path, i), 2,
                                        kCoordinate_m, violations_);
      if (p) vertices_m.emplace_back((*p)[0], (*p)[1]);
    }
    if (vertices_m.size() != items->size()) return std::nullopt;
    const auto polygon = Polygon::make(std::move(vertices_m));
    if (polygon) return polygon_patches(*polygon);
    violations_.add(node.at, fmt::format("{}: {}", path, polygon.error().message));
    return std::nullopt;
  }

  std::optional<std::vector<Patch>> read_bitmap(const Node& node, const std::string& path) {
    MapReader keys(node, path, violations_);
    const Node* file_node = keys.take("file", true);
    std::optional<std::string> file;
    if (file_node != nullptr) file = yaml::read_text(*file_node, path + ".file", violations_);
    const auto frame = read_frame(keys);
    keys.finish();
    if (!file || !frame) return std::nullopt;
    // What is transparent is no part of the shape.
    const auto image = load_bitmap(directory_ / *file, frame->dark ? 255 : 0);
    if (!image) {
      violations_.add(file_node->at, fmt::format("{}.file: {}", path, image.error().message));
      return std::nullopt;
    }
    auto patches = image_patches(*image, *frame);
    if (!patches.empty()) return patches;
    violations_.add(file_node->at,
                    fmt::format("{}.file: {} has no {} pixel; draw the shape, or set dark to {}",
                                path, *file, frame->dark ? "dark" : "bright", !frame->dark));
    return std::nullopt;
  }

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
      const auto pixel_m = yaml::read_number(*pixel_node, keys.path_of("pixel_m"),
                                             mission_fields::positive(1000), violations_);
      good = good && pixel_m.has_value();
      frame.pixel_m = pixel_m.value_or(frame.pixel_m);
    }
    if (const Node* value = keys.take("dark")) {
      static constexpr std::array<std::string_view, 2> kWords{"true", "false"};
      const auto word = yaml::read_choice(*value, keys.path_of("dark"), kWords, violations_);
      good = good && word.has_value();
      frame.dark = word != "false";
    }
    if (!good) return std::nullopt;
    return frame;
  }

  std::filesystem::path directory_;
  yaml::Violations& violations_;
};

}  // namespace

std::optional<Mixture> read_goal_shape(const Node& node, const std::string& path,
                                       const std::filesystem::path& directory,
                                       yaml::Violations& violations) {
  return GoalShapeReader(directory, violations).read(node, path);
}

}  // namespace swarm
