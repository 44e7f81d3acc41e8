// SPDX-License-Identifier: Apache-2.0
/// Points on logarithmic axes, as SVG: for people, and for docs/. Reentrant.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace cyclorama {

struct PlotSeries {
  std::string name;
  std::string colour;  ///< As SVG has it.
  std::vector<std::array<double, 2>> points;
  bool joined = false;  ///< By straight lines, in their order.
  double radius_px = 3.0;
};

struct Plot {
  std::string x_label;
  std::string y_label;
  std::vector<PlotSeries> series;  ///< The last one is on top.
};

/// Panels side by side, and one legend: the first panel's names. What has no logarithm (zero, below, NaN, infinite) is
/// left out.
[[nodiscard]] std::string plot_svg(const std::string& title, const std::vector<Plot>& panels);

}  // namespace cyclorama
