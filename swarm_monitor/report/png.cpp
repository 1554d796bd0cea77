// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/report/png.hpp"

#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <librsvg/rsvg.h>

namespace swarm::monitor {

/// The height follows from the aspect ratio of the SVG's view box. White is painted first, because
/// the map's ground is transparent at its margin.
Result<void> write_png(const std::filesystem::path& file, const std::string& svg, int width_px) {
  const auto failed = [&](const char* what) {
    return fail(ErrorCode::kEnvironment, fmt::format("{}: {}", file.string(), what));
  };
  const std::unique_ptr<RsvgHandle, void (*)(void*)> handle(
      ::rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(svg.data()), svg.size(), nullptr),
      ::g_object_unref);
  if (!handle) return failed("the image is not an SVG that can be drawn");
  gboolean has_width = FALSE, has_height = FALSE, has_box = FALSE;
  RsvgLength width{}, height{};
  RsvgRectangle box{};
  ::rsvg_handle_get_intrinsic_dimensions(handle.get(), &has_width, &width, &has_height, &height,
                                         &has_box, &box);
  if (has_box == FALSE || box.width <= 0 || box.height <= 0) return failed("no extent is known");
  const int height_px = static_cast<int>(std::lround(width_px * box.height / box.width));
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      ::cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px),
      ::cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo(::cairo_create(surface.get()),
                                                           ::cairo_destroy);
  ::cairo_set_source_rgb(cairo.get(), 1.0, 1.0, 1.0);
  ::cairo_paint(cairo.get());
  const RsvgRectangle all{0.0, 0.0, static_cast<double>(width_px), static_cast<double>(height_px)};
  if (::rsvg_handle_render_document(handle.get(), cairo.get(), &all, nullptr) == FALSE) {
    return failed("the image cannot be drawn");
  }
  const cairo_status_t status = ::cairo_surface_write_to_png(surface.get(), file.c_str());
  return status == CAIRO_STATUS_SUCCESS ? Result<void>{} : failed(::cairo_status_to_string(status));
}

}  // namespace swarm::monitor
