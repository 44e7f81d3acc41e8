// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "appliance/calibration/measured_map.h"

namespace cyclorama::scan {

/// One step of a plot's colour scale: all values up to `max`.
struct PlotStep {
  double max;
  const char* colour;
  const char* text;
};
/// Returns the colour scale for errors and sigmas in projector pixels, from good to bad; the last step is unbounded.
[[nodiscard]] std::span<const PlotStep> pixel_scale_steps();
/// Returns the colour of projector number `i`.
[[nodiscard]] const char* projector_colour(std::size_t i);

/// A plot of the wall as seen from the sweet spot, as inline SVG: azimuth across and elevation up, in degrees. It
/// extends over the directions of the maps. A value; reentrant.
class WallPlot {
 public:
  explicit WallPlot(std::span<const calibration::MeasuredMap* const> maps);

  /// Fills the part of the wall that a map covers.
  void add_area(const calibration::MeasuredMap& map, const char* colour, std::string_view name);
  /// Colours each cell of a map by its sigma.
  void add_sigmas(const calibration::MeasuredMap& map);
  struct Spot {
    Eigen::Vector3d direction;
    double value_px = 0.0;
  };
  /// Draws dots in the colours of pixel_scale_steps().
  void add_spots(std::span<const Spot> spots);
  [[nodiscard]] std::string svg(std::string_view title) const;

 private:
  [[nodiscard]] std::optional<Eigen::Vector2d> place_of(const Eigen::Vector3d& direction) const;
  template <typename Colour>
  void add_cells(const calibration::MeasuredMap& map, const Colour& path_of);
  void add_path(const std::string& path, const char* attributes, const char* colour);

  Eigen::Vector2d min_deg_{0.0, 0.0};
  Eigen::Vector2d max_deg_{1.0, 1.0};
  double px_per_deg_ = 1.0;
  std::string drawn_;
};

/// Escapes text for use between tags and in attributes.
[[nodiscard]] std::string html_text(std::string_view text);

}  // namespace cyclorama::scan
