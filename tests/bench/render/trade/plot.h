// SPDX-License-Identifier: Apache-2.0
/// SVG plots of points on logarithmic axes, for people and for docs/. Reentrant.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace cyclorama {

struct PlotSeries {
  std::string name;
  std::string colour;  ///< SVG colour.
  std::vector<std::array<double, 2>> points;
  bool joined = false;  ///< Connects the points by straight lines, in order.
  double radius_px = 3.0;
};

struct Plot {
  std::string x_label;
  std::string y_label;
  std::vector<PlotSeries> series;  ///< Drawn in order; the last one is on top.
};

/// Draws panels side by side with one legend, from the first panel's names. Values without a logarithm (zero, negative,
/// NaN, infinite) are left out.
[[nodiscard]] std::string plot_svg(const std::string& title, const std::vector<Plot>& panels);

}  // namespace cyclorama
