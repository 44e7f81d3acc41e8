// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <optional>

namespace cyclorama::calibration {

/// Three control points and their barycentric weights, which add up to 1.
struct GridWeights {
  std::array<int, 3> nodes{};
  std::array<double, 3> factors{};
};

/// Control points over a projector's picture, and the same triangles between them as in a WarpMesh. A value.
struct MapGrid {
  int width_px = 0;
  int height_px = 0;
  int cells_x = 0;
  int cells_y = 0;

  [[nodiscard]] int nodes() const { return (cells_x + 1) * (cells_y + 1); }
  [[nodiscard]] int node(int x, int y) const { return y * (cells_x + 1) + x; }
  [[nodiscard]] double cell_width() const { return static_cast<double>(width_px) / cells_x; }
  [[nodiscard]] double cell_height() const { return static_cast<double>(height_px) / cells_y; }

  /// Returns the control points around a pixel and their weights; empty outside the picture.
  [[nodiscard]] std::optional<GridWeights> weights_at(const Eigen::Vector2d& pixel) const {
    if (cells_x < 1 || cells_y < 1) return std::nullopt;
    const double u = pixel.x() / cell_width();
    const double v = pixel.y() / cell_height();
    if (!(u >= 0.0 && u <= cells_x && v >= 0.0 && v <= cells_y)) return std::nullopt;
    const int x = std::min(static_cast<int>(u), cells_x - 1);
    const int y = std::min(static_cast<int>(v), cells_y - 1);
    const double s = u - x;
    const double t = v - y;
    const int row = cells_x + 1;
    const int at = node(x, y);
    if (s >= t) return GridWeights{{at, at + 1, at + row + 1}, {1.0 - s, s - t, t}};
    return GridWeights{{at, at + row, at + row + 1}, {1.0 - t, t - s, s}};
  }
};

}  // namespace cyclorama::calibration
