// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/wall_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "appliance/calibration/map_grid.h"

namespace cyclorama::scan {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kWidth_px = 1000.0;
constexpr double kMargin_px = 40.0;
constexpr int kMaxCells = 40;  // Across a projector's picture: fine enough to see, and small enough for a page.
constexpr std::array<PlotStep, 6> kSteps{{{0.1, "#1a7f37", "to 0.1 px"},
                                          {0.25, "#7cb342", "to 0.25 px"},
                                          {0.5, "#fdd835", "to 0.5 px"},
                                          {1.0, "#fb8c00", "to 1 px"},
                                          {2.0, "#e53935", "to 2 px"},
                                          {std::numeric_limits<double>::infinity(), "#6a1b9a", "more"}}};
constexpr std::array<const char*, 8> kColours{"#1f77b4", "#d62728", "#2ca02c", "#9467bd",
                                              "#8c564b", "#e377c2", "#17becf", "#bcbd22"};

std::size_t step_of(double value_px) {
  std::size_t step = 0;
  while (step + 1 < kSteps.size() && !(value_px <= kSteps[step].max)) ++step;
  return step;
}

/// Returns azimuth and elevation in degrees; nothing for an invalid direction.
std::optional<Eigen::Vector2d> degrees_of(const Eigen::Vector3d& direction) {
  if (!direction.allFinite() || !(direction.norm() > 0.0)) return std::nullopt;
  return Eigen::Vector2d(std::atan2(direction.x(), -direction.z()) * kDegrees,
                         std::asin(std::clamp(direction.y() / direction.norm(), -1.0, 1.0)) * kDegrees);
}

/// Returns a round spacing in degrees that gives at most 14 lines, where possible.
double spacing_deg(double span_deg) {
  for (const double step : {1.0, 2.0, 5.0, 10.0, 15.0, 30.0}) {
    if (span_deg / step <= 14.0) return step;
  }
  return 45.0;
}

}  // namespace

std::span<const PlotStep> pixel_scale_steps() { return kSteps; }

const char* projector_colour(std::size_t i) { return kColours[i % kColours.size()]; }

std::string html_text(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        // Other control characters are not allowed in a page.
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n') escaped += c;
    }
  }
  return escaped;
}

WallPlot::WallPlot(std::span<const calibration::MeasuredMap* const> maps) {
  Eigen::Vector2d min = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d max = -min;
  for (const calibration::MeasuredMap* const map : maps) {
    for (const Eigen::Vector3d& direction : map->directions) {
      const auto position = degrees_of(direction);
      if (!position) continue;
      min = min.cwiseMin(*position);
      max = max.cwiseMax(*position);
    }
  }
  if (!(min.x() <= max.x())) return;
  min_deg_ = min.array() - 2.0;
  max_deg_ = max.array() + 2.0;
  px_per_deg_ = (kWidth_px - kMargin_px) / (max_deg_.x() - min_deg_.x());
}

std::optional<Eigen::Vector2d> WallPlot::place_of(const Eigen::Vector3d& direction) const {
  const auto position = degrees_of(direction);
  if (!position) return std::nullopt;
  return Eigen::Vector2d(kMargin_px + (position->x() - min_deg_.x()) * px_per_deg_,
                         (max_deg_.y() - position->y()) * px_per_deg_);
}

/// Adds a map's cells to paths. `path_of(sigma)` returns the path for a cell with this sigma; null omits the cell.
template <typename PathOf>
void WallPlot::add_cells(const calibration::MeasuredMap& map, const PathOf& path_of) {
  const calibration::MapGrid grid{map.width_px, map.height_px, map.cells_x, map.cells_y};
  const int step = std::max(1, (std::max(map.cells_x, map.cells_y) + kMaxCells - 1) / kMaxCells);
  for (int y = 0; y < map.cells_y; y += step) {
    for (int x = 0; x < map.cells_x; x += step) {
      const int right = std::min(x + step, map.cells_x);
      const int bottom = std::min(y + step, map.cells_y);
      std::array<Eigen::Vector2d, 4> corners;
      double sigma_px = 0.0;
      bool is_whole = true;
      int n = 0;
      for (const int node : {grid.node(x, y), grid.node(right, y), grid.node(right, bottom), grid.node(x, bottom)}) {
        const auto position = place_of(map.directions[static_cast<std::size_t>(node)]);
        is_whole = is_whole && position.has_value();
        sigma_px = std::max(sigma_px, map.sigma_px[static_cast<std::size_t>(node)]);
        corners[static_cast<std::size_t>(n++)] = position.value_or(Eigen::Vector2d::Zero());
      }
      // A cell across azimuth 180 degrees cannot be drawn on a flat plot.
      const bool is_torn = std::abs(corners[0].x() - corners[1].x()) > 0.5 * kWidth_px;
      std::string* const path = is_whole && !is_torn ? path_of(sigma_px) : nullptr;
      if (path == nullptr) continue;
      for (std::size_t i = 0; i < 4; ++i)
        *path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", corners[i].x(), corners[i].y());
      *path += "Z";
    }
  }
}

void WallPlot::add_path(const std::string& path, const char* attributes, const char* colour) {
  if (!path.empty()) drawn_ += fmt::format("<path {}=\"{}\" d=\"{}\"/>\n", attributes, colour, path);
}

void WallPlot::add_area(const calibration::MeasuredMap& map, const char* colour, std::string_view name) {
  std::string path;
  add_cells(map, [&](double) { return &path; });
  add_path(path, "fill-opacity=\"0.35\" fill", colour);
  const auto middle = map.direction_at({0.5 * map.width_px, 0.5 * map.height_px});
  const auto at = middle ? place_of(*middle) : std::nullopt;
  if (at) {
    drawn_ += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\" class=\"name\">{}</text>\n", at->x(),
                          at->y(), html_text(name));
  }
}

void WallPlot::add_sigmas(const calibration::MeasuredMap& map) {
  std::array<std::string, kSteps.size()> paths;
  add_cells(map, [&](double sigma_px) { return std::isfinite(sigma_px) ? &paths[step_of(sigma_px)] : nullptr; });
  for (std::size_t i = 0; i < paths.size(); ++i) add_path(paths[i], "fill-opacity=\"0.8\" fill", kSteps[i].colour);
}

void WallPlot::add_spots(std::span<const Spot> spots) {
  std::array<std::string, kSteps.size()> paths;
  for (const Spot& spot : spots) {
    const auto at = place_of(spot.direction);
    if (!at || !std::isfinite(spot.value_px)) continue;
    paths[step_of(spot.value_px)] += fmt::format("M{:.1f} {:.1f}h0", at->x(), at->y());
  }
  // The largest errors are drawn last, so that they are not hidden.
  for (std::size_t i = 0; i < paths.size(); ++i)
    add_path(paths[i], "fill=\"none\" stroke-width=\"3\" stroke-linecap=\"round\" stroke", kSteps[i].colour);
}

std::string WallPlot::svg(std::string_view title) const {
  const double height = (max_deg_.y() - min_deg_.y()) * px_per_deg_ + kMargin_px;
  const double bottom = height - kMargin_px;
  std::string grid;
  const double step = spacing_deg(max_deg_.x() - min_deg_.x());
  const auto each = [step](double min, double max, const auto& line) {
    for (double degrees = std::ceil(min / step) * step; degrees <= max; degrees += step) line(degrees);
  };
  each(min_deg_.x(), max_deg_.x(), [&](double degrees) {
    const double x = kMargin_px + (degrees - min_deg_.x()) * px_per_deg_;
    grid += fmt::format(
        "<path class=\"grid\" d=\"M{0:.1f} 0V{1:.1f}\"/><text x=\"{0:.1f}\" y=\"{2:.1f}\" "
        "text-anchor=\"middle\">{3:.0f}\u00b0</text>\n",
        x, bottom, bottom + 18.0, degrees);
  });
  each(min_deg_.y(), max_deg_.y(), [&](double degrees) {
    const double y = (max_deg_.y() - degrees) * px_per_deg_;
    grid += fmt::format(
        "<path class=\"grid\" d=\"M{0:.1f} {1:.1f}H{2:.1f}\"/><text x=\"{3:.1f}\" y=\"{4:.1f}\" "
        "text-anchor=\"end\">{5:.0f}\u00b0</text>\n",
        kMargin_px, y, kWidth_px, kMargin_px - 4.0, y + 4.0, degrees);
  });
  return fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">\n{}{}</svg>\n", kWidth_px,
                     height, html_text(title), grid, drawn_);
}

}  // namespace cyclorama::scan
